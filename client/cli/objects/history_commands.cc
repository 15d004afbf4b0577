// `objects undelete`, `purge`, `history`, `restore`, `release` and `draft`.
#include <google/protobuf/util/time_util.h>

#include <cstdio>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "client/cli/objects/commands.h"

namespace graspdb::client {
namespace {

struct WatchOptions {
  std::int64_t after = -1;  // negative: the current revision
  std::string catalog_id;   // empty: any
  bool records = false;
  double heartbeat_s = 30;
};

void PrintChange(const v1::WatchCatalogResponse& response) {
  for (const v1::ResourceChange& change : response.changes()) {
    std::printf("%lld %s %s\n", static_cast<long long>(response.catalog_revision()),
                change.kind() == v1::CHANGE_KIND_DELETED ? "deleted" : "written",
                change.name().c_str());
  }
}

absl::Status Watch(const GlobalOptions& global, const WatchOptions& options) {
  v1::WatchCatalogRequest request;
  if (options.after >= 0) request.set_after_revision(options.after);
  request.set_catalog_id(options.catalog_id);
  request.set_include_records(options.records);
  request.set_heartbeat_s(options.heartbeat_s);
  bool is_written = true;
  const auto print = [&](const v1::WatchCatalogResponse& response) -> absl::Status {
    absl::Status printed;
    if (global.json) {
      printed = PrintJson(response);
    } else {
      PrintChange(response);
    }
    is_written = WriteOutput();
    return is_written ? printed : absl::CancelledError("the output cannot be written");
  };
  absl::Status watched = Connect(global).WatchCatalog(request, print);
  return is_written ? watched : absl::OkStatus();
}

struct RevisionOptions {
  std::string id;
  std::int64_t revision = 0;
};

struct ReleaseOptions {
  std::string id;
  std::string stable_pose;  // empty: the object
};

absl::Status PrintResult(const GlobalOptions& global, const absl::StatusOr<v1::Object>& object,
                         const char* done) {
  if (!object.ok()) return object.status();
  if (global.json) return PrintJson(*object);
  std::printf("%s %s\n", done, object->name().c_str());
  return absl::OkStatus();
}

absl::Status PurgeObject(const GlobalOptions& global, const std::string& id) {
  const std::string name = ResourceName("objects", id);
  absl::Status status = Connect(global).PurgeObject(name);
  if (status.ok() && !global.json) std::printf("deleted %s for good\n", name.c_str());
  return status;
}

std::string EditText(const v1::ResourceEdit& edit) {
  if (edit.kind() == v1::EDIT_KIND_CREATED) return absl::StrCat("created ", edit.name());
  if (edit.kind() == v1::EDIT_KIND_DELETED) return absl::StrCat("deleted ", edit.name());
  return absl::StrCat("updated ", edit.name(), edit.fields().empty() ? "" : ": ",
                      absl::StrJoin(edit.fields(), ", "));
}

absl::Status ShowHistory(const GlobalOptions& global, const std::string& id) {
  ASSIGN_OR_RETURN(const auto revisions,
                   Connect(global).ListObjectRevisions(ResourceName("objects", id)));
  for (const v1::ObjectRevision& revision : revisions) {
    if (global.json) {
      RETURN_IF_ERROR(PrintJson(revision));
    } else {
      std::printf("%s", RevisionText(revision).c_str());
    }
  }
  if (revisions.empty() && !global.json) std::printf("no changes are kept\n");
  return absl::OkStatus();
}

absl::Status Restore(const GlobalOptions& global, const RevisionOptions& options) {
  v1::RestoreObjectRequest request;
  request.set_name(ResourceName("objects", options.id));
  request.set_revision(options.revision);
  return PrintResult(global, Connect(global).RestoreObject(request), "restored");
}

absl::Status SetRelease(const GlobalOptions& global, const ReleaseOptions& options,
                        v1::ReleaseState release) {
  Client client = Connect(global);
  const std::string name = ResourceName("objects", options.id);
  const char* const state = release == v1::RELEASE_STATE_DRAFT ? "draft" : "released";
  if (options.stable_pose.empty()) {
    v1::UpdateObjectRequest request;
    request.mutable_object()->set_name(name);
    request.mutable_object()->set_release(release);
    request.mutable_update_mask()->add_paths("release");
    return PrintResult(global, client.UpdateObject(request), state);
  }
  v1::UpdateStablePoseRequest request;
  request.mutable_stable_pose()->set_name(absl::StrCat(name, "/stablePoses/", options.stable_pose));
  request.mutable_stable_pose()->set_release(release);
  request.mutable_update_mask()->add_paths("release");
  ASSIGN_OR_RETURN(const auto pose, client.UpdateStablePose(request));
  if (global.json) return PrintJson(pose);
  std::printf("%s %s\n", state, pose.name().c_str());
  return absl::OkStatus();
}

void AddReleaseCommand(CLI::App& objects, const char* name, const char* text,
                       v1::ReleaseState release, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<ReleaseOptions>();
  CLI::App* command = AddCommand(objects, name, text);
  command->add_option("OBJECT", options->id, "Id, e.g. mug")->required();
  command->add_option("--stable-pose", options->stable_pose, "Only this stable pose, e.g. upright");
  command->callback(
      [=, &global] { *action = [=, &global] { return SetRelease(global, *options, release); }; });
}

}  // namespace

std::string LocalTimeText(const google::protobuf::Timestamp& time) {
  const std::int64_t seconds = google::protobuf::util::TimeUtil::TimestampToSeconds(time);
  return absl::FormatTime("%Y-%m-%d %H:%M:%S %Ez", absl::FromUnixSeconds(seconds),
                          absl::LocalTimeZone());
}

std::string RevisionText(const v1::ObjectRevision& revision) {
  std::string out =
      absl::StrCat("revision ", revision.revision(), "  ", LocalTimeText(revision.change_time()),
                   "  ", revision.method().empty() ? "by the server itself" : revision.method(),
                   revision.identity().empty() ? "" : " by ", revision.identity(), "\n");
  for (const v1::ResourceEdit& edit : revision.edits()) {
    absl::StrAppend(&out, "  ", EditText(edit), "\n");
  }
  const std::int64_t more = revision.edit_count() - revision.edits_size();
  if (more > 0) absl::StrAppend(&out, "  and ", more, " more\n");
  return out;
}

void AddHistoryCommands(CLI::App& objects, const GlobalOptions& global, Action* action) {
  AddReleaseCommand(objects, "release", "Let all cells recognise an object or stable pose",
                    v1::RELEASE_STATE_RELEASED, global, action);
  AddReleaseCommand(objects, "draft", "Let only test cells recognise an object or stable pose",
                    v1::RELEASE_STATE_DRAFT, global, action);
  auto id = std::make_shared<std::string>();
  CLI::App* undelete = AddCommand(objects, "undelete", "Bring a deleted object back");
  undelete->add_option("OBJECT", *id, "Id, e.g. mug")->required();
  undelete->callback([=, &global] {
    *action = [=, &global] {
      return PrintResult(global, Connect(global).UndeleteObject(ResourceName("objects", *id)),
                         "brought back");
    };
  });
  CLI::App* purge = AddCommand(objects, "purge", "Delete a deleted object for good");
  purge->add_option("OBJECT", *id, "Id, e.g. mug")->required();
  purge->callback([=, &global] { *action = [=, &global] { return PurgeObject(global, *id); }; });
  CLI::App* history =
      AddCommand(objects, "history", "Print what changed in an object, when and by whom");
  history->add_option("OBJECT", *id, "Id, e.g. mug; a deleted object, too")->required();
  history->callback([=, &global] { *action = [=, &global] { return ShowHistory(global, *id); }; });
  auto options = std::make_shared<RevisionOptions>();
  CLI::App* restore =
      AddCommand(objects, "restore", "Put an object back to its state after an earlier revision");
  restore->add_option("OBJECT", options->id, "Id, e.g. mug")->required();
  restore->add_option("--revision", options->revision, "As in `graspdb objects history`")
      ->required()
      ->check(WholeNumberFrom(1));
  restore->callback([=, &global] { *action = [=, &global] { return Restore(global, *options); }; });
}

void AddWatchCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "watch", "Print the changes of the catalogue as they happen");
  auto options = std::make_shared<WatchOptions>();
  command
      ->add_option("--after", options->after,
                   "Begin after this revision, 0 for all that are kept; default: new changes")
      ->check(WholeNumberFrom(0));
  command->add_option(
      "--catalog-id", options->catalog_id,
      "Id of the catalogue that --after is a revision of (graspdb status); fails if the "
      "server has another one, as after a restore");
  command->add_flag("--records", options->records,
                    "With --json also the changed records, but for views");
  command->add_option("--heartbeat", options->heartbeat_s, "Seconds between heartbeats (--json)")
      ->check(CLI::Range(1.0, 3600.0))
      ->capture_default_str();
  command->footer(
      "Ends with Ctrl-C. With --json each line has the revision in catalogRevision and the id of\n"
      "the catalogue in catalogId; continue with those of the last one without `continued`. It\n"
      "fails where the changes since then are not known: read all records again.\n\n"
      "Example: graspdb watch --after 0 --json | tee changes.jsonl");
  command->callback([=, &global] { *action = [=, &global] { return Watch(global, *options); }; });
}

}  // namespace graspdb::client
