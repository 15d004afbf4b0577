#include <openssl/sha.h>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/base/splits.h"
#include "client/cli/objects/archive_commands.h"
#include "client/cli/objects/commands.h"
#include "client/cli/objects/taught_report.h"
#include "client/teaching/upload/bulk_upload.h"
#include "files/base/json_object.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/scan_file.h"

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

// Failed views that are printed; the number of the others follows.
constexpr std::size_t kMaxPrintedFailures = 20;

struct ImportOptions {
  std::string folder;
  std::string split = "TEACH";
  bool replace = false;
  bool resume = false;
  bool atomic = false;
  bool dry_run = false;
};

// Reads a capture into a request that teaches it as a view.
absl::Status ReadView(const std::filesystem::path& folder, const v1::CaptureSet& set,
                      const v1::Capture& capture, v1::UploadViewsRequest* request) {
  ASSIGN_OR_RETURN(files::ScanFile file, files::ReadScanFile(folder / capture.path()));
  request->set_parent(StablePoseName(capture.object_id(), capture.stable_pose_id()));
  request->set_view_id(capture.view_id());
  v1::View* view = request->mutable_view();
  files::SetScan(std::move(file.scan), view);
  view->set_segmented(capture.segmented());
  if (capture.has_object_pose()) *view->mutable_object_pose() = capture.object_pose();
  if (capture.has_sensor_pose()) {
    *view->mutable_sensor_pose() = capture.sensor_pose();
  } else if (file.sensor_pose) {
    *view->mutable_sensor_pose() = files::ToMessage(*file.sensor_pose);
  }
  if (set.has_region_of_interest()) {
    *request->mutable_region_of_interest() = set.region_of_interest();
  }
  return absl::OkStatus();
}

// The same set gets the same id, so that an interrupted import is found again.
std::string UploadIdOf(const v1::CaptureSet& set, const ImportOptions& options) {
  const std::string content = absl::StrCat(options.split, options.replace, set.SerializeAsString());
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(), digest);
  return absl::StrCat("import-",
                      absl::BytesToHexString({reinterpret_cast<const char*>(digest), 8}));
}

// One import of a set.
class Import {
 public:
  Import(Client& client, const ImportOptions& options, const v1::CaptureSet& set)
      : client_(client),
        options_(options),
        set_(set),
        captures_(TeachableCaptures(set, options.split)),
        upload_id_(UploadIdOf(set, options)),
        views_({.count = captures_.size(),
                .make =
                    [this](std::size_t i, v1::UploadViewsRequest* request) {
                      return ReadView(options_.folder, set_, *captures_[i], request);
                    },
                .replace = options.replace,
                .name_of = [this](std::size_t i) { return captures_[i]->path(); }}),
        watch_({.report =
                    [this](std::size_t done) {
                      progress_.Report(static_cast<int>(done), static_cast<int>(captures_.size()));
                    },
                .cancelled = Interrupted}) {}

  absl::Status Check() const {
    if (captures_.empty()) {
      return absl::FailedPreconditionError(
          absl::StrCat(options_.folder, " has no captures to teach in split ", options_.split,
                       "; choose another --split or check captures.json"));
    }
    if (!options_.resume) return absl::OkStatus();
    const auto upload = client_.GetUpload("uploads/" + upload_id_);
    if (upload.ok() && upload->state() == v1::UPLOAD_STATE_OPEN) return absl::OkStatus();
    if (!upload.ok() && !absl::IsNotFound(upload.status())) return upload.status();
    return absl::NotFoundError(absl::StrCat("there is no interrupted import of ", options_.folder,
                                            "; leave out --resume to start one"));
  }

  absl::StatusOr<BulkUploadResult> Run() {
    RETURN_IF_ERROR(CreateParents(client_, {set_.objects().begin(), set_.objects().end()}));
    return TeachInBulk(client_, views_, {.upload_id = upload_id_, .atomic = options_.atomic},
                       watch_);
  }

  // Prints what Run() would do.
  absl::Status PrintPlan() {
    ASSIGN_OR_RETURN(const auto plan, PlanUpload(client_, views_, upload_id_, watch_));
    std::printf("would send %zu views%s; %zu are in the catalogue already, %zu were sent before",
                plan.new_count, options_.replace ? ", replacing those of the same id" : "",
                plan.existing_count, plan.staged_count);
    if (plan.repeated_count > 0) {
      std::printf(", %zu have the content of others", plan.repeated_count);
    }
    std::printf("\n");
    return FailureOf(plan.unreadable, "read");
  }

  // Prints the failed views; an error if there are any.
  absl::Status FailureOf(const std::vector<FailedView>& failed, const char* verb) const {
    if (failed.empty()) return absl::OkStatus();
    for (std::size_t i = 0; i < std::min(failed.size(), kMaxPrintedFailures); ++i) {
      std::fprintf(stderr, "%s: %s\n", captures_[failed[i].index]->path().c_str(),
                   std::string(failed[i].error.message()).c_str());
    }
    return {failed.front().error.code(),
            absl::StrCat(failed.size(), " of ", captures_.size(), " captures could not be ", verb,
                         "; fix or remove them and run the same command again")};
  }

 private:
  Client& client_;
  const ImportOptions& options_;
  const v1::CaptureSet& set_;
  const std::vector<const v1::Capture*> captures_;
  const std::string upload_id_;
  ProgressLine progress_;
  const ViewsToTeach views_;
  const UploadWatch watch_;
};

absl::Status RunImport(const GlobalOptions& global, const ImportOptions& options) {
  ASSIGN_OR_RETURN(v1::CaptureSet set, files::LoadCaptureSet(options.folder));
  Client client = Connect(global);
  Import import(client, options, set);
  RETURN_IF_ERROR(import.Check());
  if (options.dry_run) return import.PrintPlan();
  ASSIGN_OR_RETURN(const BulkUploadResult result, import.Run());
  const UploadCounts& counts = result.counts;
  ASSIGN_OR_RETURN(
      const v1::CatalogStatus status,
      ReportTaught(global, client, {.created = counts.created, .existing = counts.existing}));
  RETURN_IF_ERROR(import.FailureOf(result.failed, "taught"));
  if (global.json || counts.created == 0) return absl::OkStatus();
  return NoteLookAlikes(client, "", status);
}

constexpr char kImportFooter[] =
    R"(A capture set: objects and stable poses are created as needed; existing ones keep their grasps.
All views become part of the catalogue together, at the end, in one revision; recognition goes on
meanwhile. Captures that cannot be taught are listed, and the others taught.

An archive: the whole file is checked first. Each object, stable pose and view is then the same as
the server's, new, or different. Same ones are left alone, new ones created; views become part of
the catalogue together, in one revision, or none does. A difference is a conflict, since the
server's own may be the newer one: nothing is imported before you choose --on-conflict, and the exit
status is 1, with --dry-run too. With --base, the archive from which both began, only what both
sides changed is a conflict: what only the file changed is replaced (newer), what only the server
changed stays (older). Nothing is ever deleted. Importing a file twice changes nothing the second
time.

Run an interrupted import again to continue it: what was sent is not sent again. `graspdb uploads`
lists and drops interrupted imports.

Examples: graspdb import captures/monday
          graspdb import plant-a.graspdb --dry-run
          graspdb import plant-a.graspdb --object mug --on-conflict replace
          graspdb import june.graspdb --base may.graspdb)";

void AddArchiveFlags(CLI::App& command, ArchiveImportFlags* archive) {
  command
      .add_option("--on-conflict", archive->on_conflict,
                  "Of an archive, what to do with records that differ from the server's: fail "
                  "before anything is written, keep the server's, replace them, or take the one "
                  "that was changed later, by the clocks of both servers")
      ->check(CLI::IsMember(OnConflictNames()))
      ->capture_default_str();
  command.add_option("--base", archive->base,
                     "Of an archive, an earlier one from which both it and the server's catalogue "
                     "began");
  command.add_option("--object", archive->objects, "Of an archive, only these objects");
  command.add_flag("--no-outcomes", archive->no_outcomes,
                   "Of an archive, without raising the counts of reported picks to the file's "
                   "(which takes the role recognise)");
}

absl::Status RunAnyImport(const GlobalOptions& global, const CLI::App& command,
                          const ImportOptions& options, ArchiveImportFlags archive) {
  const bool is_archive = IsArchivePath(options.folder);
  const std::vector<std::string> others =
      is_archive ? std::vector<std::string>{"--split", "--replace", "--atomic"}
                 : std::vector<std::string>{"--on-conflict", "--base", "--object", "--no-outcomes"};
  for (const std::string& flag : others) {
    if (command.count(flag) == 0) continue;
    return absl::InvalidArgumentError(absl::StrCat(
        flag, " is for ", is_archive ? "capture sets" : "archives", ", and ", options.folder,
        is_archive ? " is an archive" : " is a folder", "; leave it out"));
  }
  if (!is_archive) return RunImport(global, options);
  archive.path = options.folder;
  archive.resume = options.resume;
  archive.dry_run = options.dry_run;
  return RunArchiveImport(global, archive);
}

}  // namespace

void AddImportCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command = AddCommand(app, "import", "Teach a capture set, or merge an archive");
  auto options = std::make_shared<ImportOptions>();
  auto archive = std::make_shared<ArchiveImportFlags>();
  command
      ->add_option("SET", options->folder,
                   "Folder with captures.json, or an archive of `export`, FILE.graspdb")
      ->required();
  AddSplitFlag(*command, &options->split);
  command->add_flag(
      "--replace", options->replace,
      "Replace views that are already in the catalogue, e.g. after poses were corrected");
  command->add_flag("--atomic", options->atomic,
                    "Teach all captures or none, where one cannot be taught");
  command->add_flag("--resume", options->resume,
                    "Only continue an interrupted import of this set; an error without one");
  command->add_flag("--dry-run", options->dry_run,
                    "Read and compare all, and print what would be done; change nothing");
  AddArchiveFlags(*command, archive.get());
  command->footer(kImportFooter);
  command->callback([=, &global] {
    *action = [=, &global] { return RunAnyImport(global, *command, *options, *archive); };
  });
}

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
