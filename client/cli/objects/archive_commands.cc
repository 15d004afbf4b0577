#include "client/cli/objects/archive_commands.h"

#include <cstdio>
#include <iterator>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/archive/archive_export.h"
#include "client/archive/archive_import.h"
#include "client/cli/base/counted.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/archive_text.h"
#include "client/cli/objects/look_alike_notes.h"

namespace graspdb::client {
namespace {

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
    return absl::FailedPreconditionError(
        absl::StrCat("of the archive's records, ", comparison.CountOf(ArchiveState::kConflict),
                     " changed on both sides, so ", consequence,
                     "; choose --on-conflict keep, replace or later, or give the archive from "
                     "which both began as --base"));
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

}  // namespace graspdb::client
