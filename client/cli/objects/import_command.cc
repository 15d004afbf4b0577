#include "client/cli/objects/import_command.h"

#include <filesystem>
#include <memory>

#include "absl/strings/str_cat.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/base/splits.h"
#include "client/cli/base/taught_report.h"
#include "client/cli/objects/look_alike_notes.h"
#include "client/teaching/upload/view_upload.h"
#include "files/capture_set.h"
#include "files/cloud_message.h"
#include "files/pose_message.h"

namespace graspdb::client {
namespace {

struct ImportOptions {
  std::string folder;
  std::string split = "TEACH";
  bool replace = false;
};

// Reads a capture into a request that teaches it as a view.
absl::Status ReadView(const std::filesystem::path& folder, const v1::CaptureSet& set,
                      const v1::Capture& capture, v1::UploadViewsRequest* request) {
  absl::StatusOr<PointFile> file = ReadPointFile(folder / capture.path());
  if (!file.ok()) return file.status();
  request->set_parent(StablePoseName(capture.object_id(), capture.stable_pose_id()));
  request->set_view_id(capture.view_id());
  v1::View* view = request->mutable_view();
  *view->mutable_cloud() = CloudMessage(*file);
  view->set_segmented(capture.segmented());
  if (capture.has_object_pose()) *view->mutable_object_pose() = capture.object_pose();
  if (capture.has_sensor_pose()) {
    *view->mutable_sensor_pose() = capture.sensor_pose();
  } else if (file->sensor_pose) {
    *view->mutable_sensor_pose() = ToMessage(*file->sensor_pose);
  }
  if (set.has_region_of_interest()) {
    *request->mutable_region_of_interest() = set.region_of_interest();
  }
  return absl::OkStatus();
}

absl::StatusOr<UploadCounts> Import(Client& client, const ImportOptions& options,
                                    const v1::CaptureSet& set) {
  const std::vector<const v1::Capture*> captures = TeachableCaptures(set, options.split);
  if (captures.empty()) {
    return absl::FailedPreconditionError(
        absl::StrCat(options.folder, " has no captures to teach in split ", options.split,
                     "; choose another --split or check captures.json"));
  }
  absl::Status parents = CreateParents(client, {set.objects().begin(), set.objects().end()});
  if (!parents.ok()) return parents;
  ProgressLine progress;
  return TeachViews(client,
                    {.count = captures.size(),
                     .make =
                         [&](std::size_t i, v1::UploadViewsRequest* request) {
                           return ReadView(options.folder, set, *captures[i], request);
                         },
                     .replace = options.replace},
                    {.report =
                         [&](std::size_t done) {
                           progress.Report(static_cast<int>(done),
                                           static_cast<int>(captures.size()));
                         },
                     .cancelled = Interrupted});
}

absl::Status RunImport(const GlobalOptions& global, const ImportOptions& options) {
  absl::StatusOr<v1::CaptureSet> set = LoadCaptureSet(options.folder);
  if (!set.ok()) return set.status();
  Client client = Connect(global);
  const absl::StatusOr<UploadCounts> counts = Import(client, options, *set);
  if (!counts.ok()) return counts.status();
  const absl::StatusOr<v1::CatalogStatus> status =
      ReportTaught(global, client, {.created = counts->created, .existing = counts->existing});
  if (!status.ok() || global.json || counts->created == 0) return status.status();
  return NoteLookAlikes(client, "", *status);
}

}  // namespace

void AddImportCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "import", "Teach the captures of a capture set");
  auto options = std::make_shared<ImportOptions>();
  command->add_option("SET", options->folder, "Folder with captures.json")->required();
  AddSplitFlag(*command, &options->split);
  command->add_flag(
      "--replace", options->replace,
      "Replace views that are already in the catalogue, e.g. after poses were corrected");
  command->footer(
      "Objects and stable poses are created as needed; existing ones keep their grasps.\n"
      "Run an interrupted import again to continue it: existing views are skipped.\n\n"
      "Example: graspdb import captures/monday");
  command->callback(
      [=, &global] { *action = [=, &global] { return RunImport(global, *options); }; });
}

}  // namespace graspdb::client
