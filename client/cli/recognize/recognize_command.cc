#include <google/protobuf/struct.pb.h>

#include <cstdio>
#include <memory>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cli/base/splits.h"
#include "client/cli/recognize/commands.h"
#include "client/cli/recognize/picture_writer.h"
#include "client/cli/recognize/scan_hint.h"
#include "client/cli/recognize/scan_source.h"
#include "client/cli/recognize/scoreboard.h"

namespace graspdb::client {
namespace {

struct RecognizeOptions {
  std::vector<std::string> inputs;
  std::string split = "ALL";
  std::string cell;
  std::string pictures;
  bool segmented = false;
  bool stable = false;
};

constexpr char kRecognizeFooter[] =
    R"(A folder is a capture set; if its ground truth is known, the printed table has the pose
errors. Without a sensor pose (captures.json, the VIEWPOINT line or the cell) the world
frame is fitted to the table in front of the sensor.

With --json each scan prints one line {"path": ..., "response": ...}, or {"path": ...,
"error": ...} if the scan was rejected; the exit status is then 1. "hint" is there too
for each EMPTY_REGION and NO_CLUSTER, and for other scans without an object whose points lie
at an unusual place.

Examples:
  graspdb recognize scan.pcd
  graspdb recognize captures/monday --split QUERY --json | jq .response.status
  graspdb recognize captures/monday --split QUERY --pictures /tmp/pictures)";

// Protobuf's JSON printer quotes it.
std::string QuotedJson(const std::string& text) {
  google::protobuf::Value quoted;
  quoted.set_string_value(text);
  return ToJson(quoted).value_or("\"\"");
}

void PrintJsonLine(const std::string& path, const std::string& key, const std::string& json,
                   const std::string& hint = "") {
  std::printf("{\"path\":%s,\"%s\":%s%s%s}\n", QuotedJson(path).c_str(), key.c_str(), json.c_str(),
              hint.empty() ? "" : ",\"hint\":", hint.empty() ? "" : QuotedJson(hint).c_str());
}

std::string ErrorJson(const absl::Status& status) {
  google::protobuf::Struct error;
  (*error.mutable_fields())["code"].set_string_value(absl::StatusCodeToString(status.code()));
  (*error.mutable_fields())["message"].set_string_value(std::string(status.message()));
  return ToJson(error).value_or("{}");
}

// Recognises one scan and prints the response.
absl::Status RecognizeOne(Client& client, const GlobalOptions& global,
                          const RecognizeOptions& options, const ScanTask& task,
                          Scoreboard* board) {
  ASSIGN_OR_RETURN(v1::RecognizeRequest request, ReadScan(task));
  if (!options.cell.empty()) request.set_cell(ResourceName("cells", options.cell));
  if (options.segmented) request.set_segmented(true);
  request.set_omit_timings(options.stable);
  ASSIGN_OR_RETURN(v1::RecognizeResponse response, client.Recognize(request));
  const std::string hint = ScanHint(request, response);
  if (global.json) {
    ASSIGN_OR_RETURN(std::string json, ToJson(response));
    PrintJsonLine(task.path, "response", json, hint);
  } else {
    board->Add(task, response);
    if (!hint.empty()) std::printf("  %s\n", hint.c_str());
  }
  if (options.pictures.empty()) return absl::OkStatus();
  return WritePicture(client, options.pictures, task, request, response);
}

absl::Status RunRecognize(const GlobalOptions& global, const RecognizeOptions& options) {
  ASSIGN_OR_RETURN(ScanTasks scans, ListScans(options.inputs, options.split));
  Client client = Connect(global);
  Scoreboard board;
  if (!global.json) Scoreboard::PrintHeader();
  int failed = 0;
  absl::Status first_error;
  for (const ScanTask& task : scans.tasks) {
    if (!WriteOutput()) return absl::OkStatus();
    if (Interrupted()) return absl::CancelledError("interrupted");
    absl::Status status = RecognizeOne(client, global, options, task, &board);
    if (status.ok()) continue;
    if (absl::IsUnavailable(status)) return status;
    first_error.Update(status);
    ++failed;
    if (global.json) PrintJsonLine(task.path, "error", ErrorJson(status));
    if (scans.tasks.size() == 1) break;
    std::fprintf(stderr, "graspdb: %s: %s\n", task.path.c_str(),
                 std::string(status.message()).c_str());
  }
  std::fflush(stdout);
  if (!global.json) board.PrintSummary();
  if (failed == 0) return absl::OkStatus();
  if (scans.tasks.size() == 1) return first_error;
  return {first_error.code(), absl::StrCat(failed, " of ", scans.tasks.size(),
                                           " scans were refused; see the messages above")};
}

}  // namespace

void AddRecognizeCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command =
      AddCommand(app, "recognize", "Recognise the objects in scans, with poses and grasps");
  auto options = std::make_shared<RecognizeOptions>();
  command
      ->add_option("INPUT", options->inputs,
                   "Point files (.pcd, .ply), depth images (.png) or capture sets")
      ->required();
  AddSplitFlag(*command, &options->split);
  command->add_option("--cell", options->cell, "Cell with the calibration and settings to use");
  command->add_flag("--segmented", options->segmented,
                    "The scan has only the points of one object, no table");
  command->add_option("--pictures", options->pictures,
                      "Folder for one PNG per scan: found, shifted, refined");
  command->add_flag("--omit-timings", options->stable,
                    "Omit measured times: the same scan gives the same bytes");
  command->footer(kRecognizeFooter);
  command->callback(
      [=, &global] { *action = [=, &global] { return RunRecognize(global, *options); }; });
}

}  // namespace graspdb::client
