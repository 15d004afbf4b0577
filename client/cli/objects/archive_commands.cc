#include "client/cli/objects/archive_commands.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <memory>
#include <string_view>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/archive/archive_export.h"
#include "client/archive/archive_import.h"
#include "client/cli/base/counted.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/taught_report.h"
#include "files/base/json_object.h"

namespace graspdb::client {
namespace {

// Lines that are printed; the number of the others follows.
constexpr std::size_t kMaxPrintedDifferences = 20;

constexpr std::array<std::string_view, 3> kKinds = {"objects", "stable poses", "views"};
constexpr std::array<std::string_view, 3> kJsonKinds = {"objects", "stablePoses", "views"};

std::string_view LaterText(LaterChange later) {
  switch (later) {
    case LaterChange::kFile:
      return "changed later in the file";
    case LaterChange::kServer:
      return "changed later on the server";
    default:
      return "changed at the same time";
  }
}

void SetComparison(const files::ArchiveIndex& index, const ArchiveComparison& comparison,
                   files::JsonObject out) {
  for (std::size_t kind = 0; kind < kJsonKinds.size(); ++kind) {
    files::JsonObject counts = out.Object(std::string(kJsonKinds[kind]));
    for (std::size_t state = 0; state < kArchiveStates; ++state) {
      counts.Set(files::Json(std::string(NameOf(static_cast<ArchiveState>(state))),
                             comparison.counts[kind][state]));
    }
  }
  out.Set(files::Json("leftOut", comparison.left_out_count),
          files::Json("joinedStablePoses", comparison.joined_stable_poses));
  out.List("differences", comparison.differences,
           [&](const ArchiveDifference& difference, files::JsonObject one) {
             one.Set(
                 files::Json("name", index.entries[difference.entry].name),
                 files::Json("state", NameOf(difference.state)),
                 files::Json("action", NameOf(difference.action)),
                 files::Json("changedLater", difference.later == LaterChange::kFile     ? "file"
                                             : difference.later == LaterChange::kServer ? "server"
                                                                                        : ""));
           });
}

std::string NotesText(const ArchiveComparison& comparison) {
  std::string out;
  const auto undecided = std::ranges::count(comparison.actions, ArchiveAction::kUndecided);
  if (undecided > 0) {
    absl::StrAppend(
        &out, Counted(undecided, "record"), undecided == 1 ? " is" : " are",
        " undecided, so that an import writes nothing; choose --on-conflict "
        "keep, replace or later, or give the archive from which both began as --base\n");
  }
  if (comparison.left_out_count > 0) {
    absl::StrAppend(&out, Counted(comparison.left_out_count, "new view"),
                    " of stable poses in conflict, which stay as they are on the server, ",
                    comparison.left_out_count == 1 ? "is" : "are", " left out\n");
  }
  const std::size_t joined = comparison.joined_stable_poses.size();
  if (joined > 0) {
    absl::StrAppend(&out, Counted(joined, "stable pose"), joined == 1 ? " gets" : " get",
                    " grasps or views of the file beside others of the server, as ",
                    comparison.joined_stable_poses.front(),
                    ": right if both were taught in the same frame of the object\n");
  }
  return out;
}

std::string ResultText(const ArchiveComparison& comparison, const ArchiveImportCounts& counts,
                       const v1::CatalogStatus& status) {
  std::string out = absl::StrFormat(
      "created %s, %s and %s, replaced %s; %d were the same, %d stay as they are on the server\n",
      Counted(counts.created_objects, "object"),
      Counted(counts.created_stable_poses, "stable pose"), Counted(counts.created_views, "view"),
      Counted(counts.replaced, "record"), comparison.CountOf(ArchiveState::kSame),
      std::ranges::count(comparison.actions, ArchiveAction::kKeep));
  out += NotesText(comparison);
  if (counts.raised_outcomes > 0) {
    absl::StrAppend(&out, "raised the counts of picks of ",
                    Counted(counts.raised_outcomes, "stable pose"), "\n");
  }
  return out + absl::StrCat("the catalogue has ", Counted(status.view_count(), "view"), " of ",
                            Counted(status.object_count(), "object"), "\n");
}

google::protobuf::Struct ResultDocument(const files::ArchiveIndex& index,
                                        const ArchiveComparison& comparison,
                                        const ArchiveImportCounts& counts,
                                        const v1::CatalogStatus& status) {
  google::protobuf::Struct out;
  files::JsonObject object(&out);
  SetComparison(index, comparison, object);
  object.Set(files::Json("createdObjects", counts.created_objects),
             files::Json("createdStablePoses", counts.created_stable_poses),
             files::Json("createdViews", counts.created_views),
             files::Json("replaced", counts.replaced),
             files::Json("raisedOutcomes", counts.raised_outcomes),
             files::Json("catalogRevision", status.catalog_revision()));
  return out;
}

constexpr std::pair<const char*, OnConflict> kOnConflict[] = {{"fail", OnConflict::kFail},
                                                              {"keep", OnConflict::kKeep},
                                                              {"replace", OnConflict::kReplace},
                                                              {"later", OnConflict::kLater}};

OnConflict OnConflictOf(const std::string& name) {
  for (const auto& [known, value] : kOnConflict) {
    if (name == known) return value;
  }
  return OnConflict::kFail;
}

std::vector<std::string> ObjectNames(const std::vector<std::string>& ids) {
  std::vector<std::string> out;
  out.reserve(ids.size());
  for (const std::string& id : ids) out.push_back(ResourceName("objects", id));
  return out;
}

// An open file with its index.
struct CheckedArchive {
  std::unique_ptr<files::ArchiveFile> file;
  files::ArchiveIndex index;
};

absl::StatusOr<CheckedArchive> CheckArchive(const std::string& path) {
  ASSIGN_OR_RETURN(auto file, files::ArchiveFile::Open(path));
  CheckedArchive out = {.file = std::move(file), .index = {}};
  absl::StatusOr<files::ArchiveIndex> index =
      files::IndexArchive(*out.file, [](std::int64_t /*bytes*/) {
        return Interrupted() ? absl::CancelledError("interrupted; nothing was changed")
                             : absl::OkStatus();
      });
  if (!index.ok()) return index.status();
  if (index->has_unknown_fields) {
    std::fprintf(stderr,
                 "%s has fields that this version does not know, which are left out; use the "
                 "version that wrote it to import all\n",
                 path.c_str());
  }
  out.index = *std::move(index);
  return out;
}

// One import of an archive.
class ArchiveCommand {
 public:
  ArchiveCommand(const GlobalOptions& global, const ArchiveImportFlags& flags,
                 const CheckedArchive& checked)
      : global_(global),
        flags_(flags),
        client_(Connect(global)),
        archive_{*checked.file, checked.index} {}

  absl::Status Run(const OpenArchive* base) {
    ASSIGN_OR_RETURN(ArchiveComparison comparison, Compare(base));
    if (flags_.dry_run) return PrintComparison(comparison);
    RETURN_IF_ERROR(CheckConflicts(comparison));
    RETURN_IF_ERROR(CheckResume(comparison));
    return Import(comparison);
  }

 private:
  absl::StatusOr<ArchiveComparison> Compare(const OpenArchive* base) {
    ProgressLine progress("records compared");
    const ComparisonWatch watch = {.report =
                                       [&](std::size_t done) {
                                         progress.Report(
                                             static_cast<int>(done),
                                             static_cast<int>(archive_.index.entries.size()));
                                       },
                                   .cancelled = Interrupted};
    const ComparisonOptions options = {.on_conflict = OnConflictOf(flags_.on_conflict),
                                       .objects = ObjectNames(flags_.objects),
                                       .base = base};
    return CompareArchive(client_, archive_, options, watch);
  }

  absl::Status PrintComparison(const ArchiveComparison& comparison) const {
    if (global_.json) {
      RETURN_IF_ERROR(PrintJson(ComparisonDocument(archive_.index, comparison)));
    } else {
      std::fputs(ComparisonText(archive_.index, comparison).c_str(), stdout);
    }
    return HasUndecided(comparison) ? Undecided(comparison, "an import would write nothing")
                                    : absl::OkStatus();
  }

  bool HasUndecided(const ArchiveComparison& comparison) const {
    return comparison.CountOf(ArchiveState::kConflict) > 0 &&
           OnConflictOf(flags_.on_conflict) == OnConflict::kFail;
  }

  static absl::Status Undecided(const ArchiveComparison& comparison, const char* consequence) {
    const std::int64_t count = comparison.CountOf(ArchiveState::kConflict);
    return absl::FailedPreconditionError(absl::StrCat(
        count, count == 1 ? " record of the archive was" : " records of the archive were",
        " changed on both sides, so ", consequence,
        "; choose --on-conflict keep, replace or later, or name the archive that both sides "
        "started from with --base"));
  }

  absl::Status CheckConflicts(const ArchiveComparison& comparison) const {
    if (!HasUndecided(comparison)) return absl::OkStatus();
    std::fputs(DifferencesText(archive_.index, comparison).c_str(), stderr);
    return Undecided(comparison, "nothing was imported");
  }

  absl::Status CheckResume(const ArchiveComparison& comparison) {
    if (!flags_.resume) return absl::OkStatus();
    for (const std::string& id : UploadIdsOf(archive_.index, comparison)) {
      const absl::StatusOr<v1::Upload> upload = client_.GetUpload("uploads/" + id);
      if (upload.ok() && upload->state() == v1::UPLOAD_STATE_OPEN) return absl::OkStatus();
      if (!upload.ok() && !absl::IsNotFound(upload.status())) return upload.status();
    }
    return absl::NotFoundError(absl::StrCat("there is no interrupted import of ", flags_.path,
                                            " with these options; leave out --resume to start "
                                            "one"));
  }

  absl::Status Import(const ArchiveComparison& comparison) {
    ProgressLine progress("views");
    const auto total =
        static_cast<int>(CountOf(archive_.index, comparison, files::ArchiveKind::kView));
    const UploadWatch watch = {
        .report = [&](std::size_t done) { progress.Report(static_cast<int>(done), total); },
        .cancelled = Interrupted};
    ASSIGN_OR_RETURN(
        const ArchiveImportCounts counts,
        ImportArchive(client_, archive_, comparison, {.outcomes = !flags_.no_outcomes}, watch));
    ASSIGN_OR_RETURN(const v1::CatalogStatus status, client_.GetCatalogStatus());
    if (global_.json) {
      return PrintJson(ResultDocument(archive_.index, comparison, counts, status));
    }
    std::fputs(ResultText(comparison, counts, status).c_str(), stdout);
    return counts.created_views == 0 ? absl::OkStatus() : NoteLookAlikes(client_, "", status);
  }

  const GlobalOptions& global_;
  const ArchiveImportFlags& flags_;
  Client client_;
  const OpenArchive archive_;
};

// What an import did.
}  // namespace

bool IsArchivePath(const std::filesystem::path& path) {
  std::error_code error;
  return path.string().ends_with(files::kArchiveSuffix) ||
         std::filesystem::is_regular_file(path, error);
}

std::vector<std::string> OnConflictNames() {
  std::vector<std::string> out;
  out.reserve(std::size(kOnConflict));
  for (const auto& [name, value] : kOnConflict) out.emplace_back(name);
  return out;
}

absl::Status RunArchiveExport(const GlobalOptions& global, const std::string& path,
                              const std::vector<std::string>& object_ids) {
  std::error_code error;
  if (std::filesystem::exists(path, error)) {
    return absl::AlreadyExistsError(absl::StrCat(path, " exists; choose another file"));
  }
  Client client = Connect(global);
  ProgressLine progress("views");
  const ExportWatch watch = {.report =
                                 [&](std::int64_t done, std::int64_t total) {
                                   progress.Report(static_cast<int>(done), static_cast<int>(total));
                                 },
                             .cancelled = Interrupted};
  ASSIGN_OR_RETURN(const ExportResult result,
                   ExportArchive(client, ObjectNames(object_ids), path, watch));
  const v1::ArchiveEnd& end = result.end;
  if (end.catalog_revision() != result.header.catalog_revision()) {
    std::fprintf(stderr,
                 "the catalogue changed from revision %lld to %lld meanwhile; %s may have some of "
                 "these changes without others\n",
                 static_cast<long long>(result.header.catalog_revision()),
                 static_cast<long long>(end.catalog_revision()), path.c_str());
  }
  if (global.json) return PrintJson(end);
  std::printf("wrote %s of %s at revision %lld to %s\n", Counted(end.view_count(), "view").c_str(),
              Counted(end.object_count(), "object").c_str(),
              static_cast<long long>(end.catalog_revision()), path.c_str());
  return absl::OkStatus();
}

absl::Status RunArchiveImport(const GlobalOptions& global, const ArchiveImportFlags& flags) {
  ASSIGN_OR_RETURN(const CheckedArchive checked, CheckArchive(flags.path));
  if (flags.base.empty()) return ArchiveCommand(global, flags, checked).Run(nullptr);
  ASSIGN_OR_RETURN(const CheckedArchive base, CheckArchive(flags.base));
  const OpenArchive open = {*base.file, base.index};
  return ArchiveCommand(global, flags, checked).Run(&open);
}

std::int64_t CountOf(const files::ArchiveIndex& index, const ArchiveComparison& comparison,
                     files::ArchiveKind kind) {
  std::int64_t out = 0;
  for (std::size_t i = 0; i < index.entries.size(); ++i) {
    const ArchiveAction action = comparison.actions[i];
    const bool counts = action == ArchiveAction::kCreate || action == ArchiveAction::kReplace;
    out += index.entries[i].kind == kind && counts ? 1 : 0;
  }
  return out;
}

std::string DifferencesText(const files::ArchiveIndex& index, const ArchiveComparison& comparison) {
  std::string out;
  const std::size_t count = comparison.differences.size();
  for (std::size_t i = 0; i < std::min(count, kMaxPrintedDifferences); ++i) {
    const ArchiveDifference& difference = comparison.differences[i];
    absl::StrAppendFormat(&out, "%-8s %-9s %s, %s\n", std::string(NameOf(difference.state)),
                          std::string(NameOf(difference.action)),
                          index.entries[difference.entry].name,
                          std::string(LaterText(difference.later)));
  }
  if (count > kMaxPrintedDifferences) {
    absl::StrAppend(&out, "and ", Counted(count - kMaxPrintedDifferences, "other"), "\n");
  }
  return out;
}

std::string ComparisonText(const files::ArchiveIndex& index, const ArchiveComparison& comparison) {
  std::string out = absl::StrFormat("%-12s", "in the file");
  for (std::size_t state = 0; state < kArchiveStates; ++state) {
    absl::StrAppendFormat(&out, " %9s", std::string(NameOf(static_cast<ArchiveState>(state))));
  }
  out += '\n';
  for (std::size_t kind = 0; kind < kKinds.size(); ++kind) {
    absl::StrAppendFormat(&out, "%-12s", std::string(kKinds[kind]));
    for (const std::int64_t count : comparison.counts[kind]) {
      absl::StrAppendFormat(&out, " %9d", count);
    }
    out += '\n';
  }
  return out + DifferencesText(index, comparison) + NotesText(comparison);
}

google::protobuf::Struct ComparisonDocument(const files::ArchiveIndex& index,
                                            const ArchiveComparison& comparison) {
  google::protobuf::Struct out;
  SetComparison(index, comparison, files::JsonObject(&out));
  return out;
}

}  // namespace graspdb::client
