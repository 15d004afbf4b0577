#include "client/cli/objects/archive_text.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/base/counted.h"
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

}  // namespace

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

}  // namespace graspdb::client
