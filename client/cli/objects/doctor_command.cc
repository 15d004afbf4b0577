#include <cstdio>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "client/cli/objects/commands.h"
#include "client/cli/objects/doctor_checks.h"
#include "client/teaching/turntable/look_alikes_text.h"
#include "files/json_object.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

const char* NameOf(Severity severity) {
  switch (severity) {
    case Severity::kAdvice:
      return "advice";
    case Severity::kWarning:
      return "warning";
    case Severity::kError:
      return "error";
  }
  return "";
}

absl::Status CheckObjects(Client& client, Findings* out) {
  const auto objects = client.ListObjects();
  if (!objects.ok()) return objects.status();
  for (const v1::Object& object : *objects) {
    const auto poses = client.ListStablePoses(object.name());
    if (!poses.ok()) return poses.status();
    CheckObject(object, *poses, out);
    for (const v1::StablePose& pose : *poses) {
      const auto views = client.ListViews(pose.name());
      if (!views.ok()) return views.status();
      CheckStablePose(pose, views->size(), out);
    }
  }
  const auto alike = client.FindLookAlikes("");
  if (!alike.ok()) return alike.status();
  for (std::string& text : LookAlikesText(*alike, /*nearly_too=*/false)) {
    out->push_back({Severity::kWarning, "catalogue", std::move(text)});
  }
  return absl::OkStatus();
}

absl::StatusOr<Findings> CheckAll(Client& client) {
  Findings out;
  const auto status = client.GetCatalogStatus();
  if (!status.ok()) return status.status();
  CheckServer(*status, kVersion, &out);
  if (absl::Status checked = CheckObjects(client, &out); !checked.ok()) return checked;
  const auto cells = client.ListCells();
  if (!cells.ok()) return cells.status();
  for (const v1::Cell& cell : *cells) CheckCell(cell, &out);
  const auto uploads = client.ListUploads();
  if (!uploads.ok()) return uploads.status();
  for (const v1::Upload& upload : *uploads) CheckUpload(upload, absl::Now(), &out);
  return out;
}

absl::Status Print(const GlobalOptions& global, const Finding& finding) {
  if (!global.json) {
    std::printf("%-8s %s: %s\n", NameOf(finding.severity), finding.subject.c_str(),
                finding.text.c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct document;
  JsonObject(&document).Set(Json("severity", NameOf(finding.severity)),
                            Json("subject", finding.subject), Json("text", finding.text));
  return PrintJson(document);
}

absl::Status RunDoctor(const GlobalOptions& global) {
  Client client = Connect(global);
  const absl::StatusOr<Findings> findings = CheckAll(client);
  if (!findings.ok()) return findings.status();
  std::size_t serious = 0;
  for (const Finding& finding : *findings) {
    if (absl::Status printed = Print(global, finding); !printed.ok()) return printed;
    serious += finding.severity == Severity::kAdvice ? 0 : 1;
  }
  if (findings->empty() && !global.json) std::printf("no problems found\n");
  if (serious == 0) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(serious, " warnings and errors; see above"));
}

}  // namespace

void AddDoctorCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(
      app, "doctor", "Check server, catalogue, cells and uploads for mistakes, with advice");
  command->footer(
      "A line for each finding: advice, warning or error. With --json one document a line with\n"
      "severity, subject and text. Exit status: 0 without warnings and errors, 1 with some.");
  command->callback([=, &global] { *action = [&global] { return RunDoctor(global); }; });
}

}  // namespace graspdb::client
