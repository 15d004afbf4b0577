#include <cstdio>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/objects/commands.h"
#include "files/base/json_object.h"

namespace graspdb::client {
namespace {

std::string TextOf(const v1::Upload& upload) {
  if (upload.state() == v1::UPLOAD_STATE_COMMITTED) {
    return absl::StrFormat("committed in revision %d: %d new, %d existing, %d replaced, %d failed",
                           upload.commit_revision(), upload.created_count(),
                           upload.existing_count(), upload.replaced_count(),
                           upload.failed_view_count());
  }
  std::string out = absl::StrFormat("open: %d views sent", upload.staged_view_count());
  if (upload.expected_view_count() > 0) {
    absl::StrAppend(&out, " of ", upload.expected_view_count());
  }
  absl::StrAppend(&out, ", ", upload.failed_view_count(), " failed");
  if (upload.views_per_second() > 0) {
    absl::StrAppendFormat(&out, ", %.1f a second", upload.views_per_second());
  }
  if (upload.has_time_left_s()) absl::StrAppendFormat(&out, ", %.0f s left", upload.time_left_s());
  return out;
}

absl::Status Print(const GlobalOptions& global, const v1::Upload& upload) {
  if (global.json) return PrintJson(upload);
  std::printf("%-40s %s\n", upload.name().c_str(), TextOf(upload).c_str());
  return absl::OkStatus();
}

absl::Status ListUploads(const GlobalOptions& global) {
  ASSIGN_OR_RETURN(const auto uploads, Connect(global).ListUploads());
  for (const v1::Upload& upload : uploads) {
    RETURN_IF_ERROR(Print(global, upload));
  }
  if (uploads.empty() && !global.json) std::printf("there are no uploads\n");
  return absl::OkStatus();
}

absl::Status ShowUpload(const GlobalOptions& global, const std::string& id) {
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const auto upload, client.GetUpload(ResourceName("uploads", id)));
  ASSIGN_OR_RETURN(auto views, client.ListUploadViews(upload.name()));
  std::erase_if(views, [](const v1::UploadView& view) { return !view.has_error(); });
  if (global.json) {
    ASSIGN_OR_RETURN(google::protobuf::Struct document, ToDocument(upload));
    files::JsonObject(&document).List(
        "failedViews", views, [](const v1::UploadView& view, files::JsonObject out) {
          out.Set(files::Json("name", view.name()), files::Json("error", view.error().message()));
        });
    return PrintJson(document);
  }
  RETURN_IF_ERROR(Print(global, upload));
  for (const v1::UploadView& view : views) {
    std::printf("  %s: %s\n", view.name().c_str(), view.error().message().c_str());
  }
  return absl::OkStatus();
}

absl::Status CommitUpload(const GlobalOptions& global, const std::string& id, bool skip_failed) {
  v1::CommitUploadRequest request;
  request.set_name(ResourceName("uploads", id));
  request.set_skip_failed(skip_failed);
  ASSIGN_OR_RETURN(const auto upload, Connect(global).CommitUpload(request));
  return Print(global, upload);
}

absl::Status DeleteUpload(const GlobalOptions& global, const std::string& id) {
  const std::string name = ResourceName("uploads", id);
  absl::Status deleted = Connect(global).DeleteUpload(name);
  if (deleted.ok() && !global.json) std::printf("deleted %s\n", name.c_str());
  return deleted;
}

}  // namespace

void AddUploadsCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* uploads =
      AddCommand(app, "uploads", "List, show, commit and delete bulk uploads, e.g. of `import`");
  uploads->require_subcommand(1);
  AddCommand(*uploads, "list", "List all uploads with their progress")->callback([=, &global] {
    *action = [&global] { return ListUploads(global); };
  });
  auto id = std::make_shared<std::string>();
  const auto add = [&](const char* name, const char* description) {
    CLI::App* command = AddCommand(*uploads, name, description);
    command->add_option("UPLOAD", *id, "Id, as in the list")->required();
    return command;
  };
  add("show", "Print an upload and its failed views; with --json the upload alone")
      ->callback([=, &global] { *action = [=, &global] { return ShowUpload(global, *id); }; });
  auto skip_failed = std::make_shared<bool>(false);
  CLI::App* commit = add("commit", "Make the views of an upload part of the catalogue");
  commit->add_flag("--skip-failed", *skip_failed, "Without those that cannot be taught");
  commit->callback(
      [=, &global] { *action = [=, &global] { return CommitUpload(global, *id, *skip_failed); }; });
  add("delete", "Drop an upload; views that are committed stay")->callback([=, &global] {
    *action = [=, &global] { return DeleteUpload(global, *id); };
  });
}

}  // namespace graspdb::client
