#include "client/archive/archive_import.h"

#include <openssl/sha.h>

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <utility>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::client {
namespace {

// The contract's limit for a report.
constexpr std::int64_t kOutcomesPerReport = 10'000;
// Counts above are treated as this one: 100 reports. Grasps are ranked by shares, which hardly
// differ from there on.
constexpr std::int64_t kMaxRaisedCount = 1'000'000;

// By grasp.
using OutcomeCounts = std::map<std::string, v1::GraspOutcomeCounts>;

OutcomeCounts CountsOf(const v1::StablePose& pose) {
  OutcomeCounts out;
  for (const v1::GraspOutcomeCounts& counts : pose.grasp_outcomes()) {
    out[counts.grasp_id()] = counts;
  }
  return out;
}

std::int64_t Missing(std::int64_t file, std::int64_t server) {
  return std::clamp<std::int64_t>(file, 0, kMaxRaisedCount) -
         std::clamp<std::int64_t>(server, 0, kMaxRaisedCount);
}

// Whether anything was reported.
absl::StatusOr<bool> RaiseGrasp(const std::string& pose, const v1::GraspOutcomeCounts& file,
                                const v1::GraspOutcomeCounts& server, Client& client,
                                const std::function<absl::Status()>& go_on) {
  v1::ReportGraspOutcomeRequest request;
  request.set_name(pose);
  request.set_grasp_id(file.grasp_id());
  bool raised = false;
  const std::array<std::pair<v1::GraspOutcome, std::int64_t>, 3> missing = {{
      {v1::GRASP_OUTCOME_PICKED, Missing(file.picked_count(), server.picked_count())},
      {v1::GRASP_OUTCOME_MISSED, Missing(file.missed_count(), server.missed_count())},
      {v1::GRASP_OUTCOME_SLIPPED, Missing(file.slipped_count(), server.slipped_count())},
  }};
  for (auto [outcome, count] : missing) {
    request.set_outcome(outcome);
    for (; count > 0; count -= kOutcomesPerReport) {
      RETURN_IF_ERROR(go_on());
      request.set_count(static_cast<int>(std::min(count, kOutcomesPerReport)));
      RETURN_IF_ERROR(client.ReportGraspOutcome(request).status());
      raised = true;
    }
  }
  return raised;
}

// Raises the server's counts of picks of this stable pose to the file's, where they are lower, and
// returns whether any was. Counts of grasps that the server does not have are left out. Calls
// `go_on` before each report; an error of its own ends it. Errors of the server.
absl::StatusOr<bool> RaiseOutcomesTo(const v1::StablePose& file, Client& client,
                                     const std::function<absl::Status()>& go_on) {
  if (file.grasp_outcomes().empty()) return false;
  ASSIGN_OR_RETURN(const v1::StablePose server, client.GetStablePose(file.name()));
  const OutcomeCounts wanted = CountsOf(file);
  OutcomeCounts counted = CountsOf(server);
  bool raised = false;
  // The loop is over the server's grasps, at most 64. The file may count others too.
  for (const v1::Grasp& grasp : server.grasps()) {
    const auto found = wanted.find(grasp.grasp_id());
    if (found == wanted.end()) continue;
    ASSIGN_OR_RETURN(const bool done, RaiseGrasp(file.name(), found->second,
                                                 counted[grasp.grasp_id()], client, go_on));
    raised |= done;
  }
  return raised;
}

// The contract's limit for an upload.
constexpr std::size_t kViewsPerUpload = 100'000;
constexpr std::size_t kUploadIdBytes = 8;

std::string IdOf(const std::string& name) { return name.substr(name.rfind('/') + 1); }
std::string StablePoseOf(const std::string& view) { return view.substr(0, view.find("/views/")); }
std::string ObjectOf(const std::string& pose) { return pose.substr(0, pose.find("/stablePoses/")); }

bool IsSent(ArchiveAction action) {
  return action == ArchiveAction::kCreate || action == ArchiveAction::kReplace;
}

// The entries of the views to send.
std::vector<std::size_t> ViewsOf(const files::ArchiveIndex& index,
                                 const ArchiveComparison& comparison) {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < index.entries.size(); ++i) {
    if (index.entries[i].kind == files::ArchiveKind::kView && IsSent(comparison.actions[i])) {
      out.push_back(i);
    }
  }
  return out;
}

bool ReplacesAny(const std::vector<std::size_t>& views, const ArchiveComparison& comparison) {
  return std::ranges::any_of(
      views, [&](std::size_t i) { return comparison.actions[i] == ArchiveAction::kReplace; });
}

absl::Status ChangedMeanwhile(const absl::Status& status) {
  if (!absl::IsAlreadyExists(status) && !absl::IsAborted(status) && !absl::IsNotFound(status)) {
    return status;
  }
  return absl::AbortedError(
      absl::StrCat("the server's catalogue changed since it was compared; run the command again (",
                   std::string(status.message()), ")"));
}

// The server's error names a field of the request, not the record.
absl::Status AtRecord(const std::string& name, const absl::Status& status) {
  if (!absl::IsInvalidArgument(status)) return status;
  return absl::InvalidArgumentError(
      absl::StrCat("the server rejects ", name, " of the file: ", status.message()));
}

class ArchiveImport {
 public:
  ArchiveImport(Client& client, const OpenArchive& archive, const ArchiveComparison& comparison,
                const ArchiveImportOptions& options, const UploadWatch& watch)
      : client_(client),
        file_(archive.file),
        entries_(archive.index.entries),
        comparison_(comparison),
        options_(options),
        watch_(watch),
        upload_ids_(UploadIdsOf(archive.index, comparison)),
        views_(ViewsOf(archive.index, comparison)) {}

  absl::StatusOr<ArchiveImportCounts> Run() {
    if (absl::Status done = CreateParents(); !done.ok()) return ChangedMeanwhile(done);
    for (std::size_t i = 0; i < upload_ids_.size(); ++i) {
      RETURN_IF_ERROR(SendViews(i));
    }
    if (absl::Status done = ReplaceParents(); !done.ok()) return ChangedMeanwhile(done);
    for (std::size_t i = 0; options_.outcomes && i < entries_.size(); ++i) {
      if (absl::Status done = RaiseOutcomes(i); !done.ok()) return ChangedMeanwhile(done);
    }
    if (existing_ == 0) return counts_;
    return absl::AbortedError(absl::StrCat(
        "the server got ", existing_,
        " views under names of the file since it was compared, which stay, and all else was "
        "imported; run the command again to compare them"));
  }

 private:
  absl::Status GoOn() const {
    if (!watch_.cancelled || !watch_.cancelled()) return absl::OkStatus();
    return absl::CancelledError("interrupted; run the same command again to go on");
  }

  absl::Status CreateParents() {
    for (std::size_t i = 0; i < entries_.size(); ++i) {
      const files::ArchiveEntry& entry = entries_[i];
      if (entry.kind == files::ArchiveKind::kView) continue;
      if (comparison_.actions[i] != ArchiveAction::kCreate) continue;
      RETURN_IF_ERROR(GoOn());
      ASSIGN_OR_RETURN(const files::ArchiveItem item, file_.ReadAt(entry.offset));
      absl::Status created = entry.kind == files::ArchiveKind::kObject
                                 ? CreateObject(entry.name, item.record.object())
                                 : CreateStablePose(entry.name, item.record.stable_pose());
      if (!created.ok()) return AtRecord(entry.name, created);
    }
    return absl::OkStatus();
  }

  absl::Status CreateObject(const std::string& name, const v1::Object& object) {
    v1::CreateObjectRequest request;
    request.set_object_id(IdOf(name));
    *request.mutable_object() = ContentOf(object);
    ++counts_.created_objects;
    return client_.CreateObject(request).status();
  }

  absl::Status CreateStablePose(const std::string& name, const v1::StablePose& pose) {
    v1::CreateStablePoseRequest request;
    request.set_parent(ObjectOf(name));
    request.set_stable_pose_id(IdOf(name));
    *request.mutable_stable_pose() = ContentOf(pose);
    ++counts_.created_stable_poses;
    return client_.CreateStablePose(request).status();
  }

  // The views of one upload.
  absl::Status SendViews(std::size_t upload) {
    const std::size_t first = upload * kViewsPerUpload;
    const ViewsToTeach views = {
        .count = std::min(kViewsPerUpload, views_.size() - first),
        .make = [&](std::size_t i,
                    v1::UploadViewsRequest* request) { return MakeView(first + i, request); },
        .replace = ReplacesAny(views_, comparison_),
        .name_of = [&](std::size_t i) { return entries_[views_[first + i]].name; }};
    const UploadWatch watch = {.report =
                                   [&](std::size_t done) {
                                     if (watch_.report) watch_.report(first + done);
                                   },
                               .cancelled = watch_.cancelled};
    ASSIGN_OR_RETURN(
        const BulkUploadResult result,
        TeachInBulk(client_, views, {.upload_id = upload_ids_[upload], .atomic = true}, watch));
    existing_ += result.counts.existing;
    for (std::size_t i = first; i < first + views.count; ++i) {
      const bool replaced = comparison_.actions[views_[i]] == ArchiveAction::kReplace;
      ++(replaced ? counts_.replaced : counts_.created_views);
    }
    return absl::OkStatus();
  }

  // From several threads.
  absl::Status MakeView(std::size_t i, v1::UploadViewsRequest* request) const {
    const files::ArchiveEntry& entry = entries_[views_[i]];
    ASSIGN_OR_RETURN(files::ArchiveItem item, file_.ReadAt(entry.offset));
    request->set_parent(StablePoseOf(entry.name));
    request->set_view_id(IdOf(entry.name));
    v1::View* view = request->mutable_view();
    *view = std::move(*item.record.mutable_view());
    view->clear_name();
    view->clear_point_count();
    view->clear_create_time();
    view->set_segmented(true);
    return absl::OkStatus();
  }

  // All that the server has not changed meanwhile, and without interruption: before, their views
  // may be those of the file already, and their grasps those of the server.
  absl::Status ReplaceParents() {
    absl::Status changed;
    for (const ArchiveDifference& difference : comparison_.differences) {
      const files::ArchiveEntry& entry = entries_[difference.entry];
      if (difference.action != ArchiveAction::kReplace || entry.kind == files::ArchiveKind::kView) {
        continue;
      }
      ASSIGN_OR_RETURN(const files::ArchiveItem item, file_.ReadAt(entry.offset));
      absl::Status replaced = entry.kind == files::ArchiveKind::kObject
                                  ? Replace(item.record.object(), difference.etag)
                                  : Replace(item.record.stable_pose(), difference.etag);
      changed.Update(replaced);
      if (!replaced.ok() && !absl::IsAborted(replaced) && !absl::IsNotFound(replaced)) {
        return AtRecord(entry.name, replaced);
      }
      counts_.replaced += replaced.ok() ? 1 : 0;
    }
    return changed;
  }

  absl::Status Replace(const v1::Object& object, const std::string& etag) {
    v1::UpdateObjectRequest request;
    *request.mutable_object() = ContentOf(object);
    request.mutable_object()->set_name(object.name());
    request.mutable_object()->set_etag(etag);
    return client_.UpdateObject(request).status();
  }

  absl::Status Replace(const v1::StablePose& pose, const std::string& etag) {
    v1::UpdateStablePoseRequest request;
    *request.mutable_stable_pose() = ContentOf(pose);
    request.mutable_stable_pose()->set_name(pose.name());
    request.mutable_stable_pose()->set_etag(etag);
    return client_.UpdateStablePose(request).status();
  }

  // Of a stable pose whose grasps are those of the file.
  absl::Status RaiseOutcomes(std::size_t i) {
    const files::ArchiveEntry& entry = entries_[i];
    const ArchiveAction action = comparison_.actions[i];
    const bool is_of_file = action == ArchiveAction::kNothing || IsSent(action);
    if (entry.kind != files::ArchiveKind::kStablePose || !is_of_file) return absl::OkStatus();
    RETURN_IF_ERROR(GoOn());
    ASSIGN_OR_RETURN(const files::ArchiveItem item, file_.ReadAt(entry.offset));
    ASSIGN_OR_RETURN(const bool raised, RaiseOutcomesTo(item.record.stable_pose(), client_,
                                                        [this] { return GoOn(); }));
    counts_.raised_outcomes += raised ? 1 : 0;
    return absl::OkStatus();
  }

  Client& client_;
  const files::ArchiveFile& file_;
  const std::vector<files::ArchiveEntry>& entries_;
  const ArchiveComparison& comparison_;
  const ArchiveImportOptions& options_;
  const UploadWatch& watch_;
  const std::vector<std::string> upload_ids_;
  const std::vector<std::size_t> views_;
  ArchiveImportCounts counts_;
  int existing_ = 0;  // views that the server got since the comparison
};

}  // namespace

std::vector<std::string> UploadIdsOf(const files::ArchiveIndex& index,
                                     const ArchiveComparison& comparison) {
  const std::vector<std::size_t> views = ViewsOf(index, comparison);
  const bool replaces = ReplacesAny(views, comparison);
  std::vector<std::string> out;
  for (std::size_t first = 0; first < views.size(); first += kViewsPerUpload) {
    std::string content = absl::StrCat(index.digest, replaces);
    const std::size_t last = std::min(first + kViewsPerUpload, views.size());
    for (std::size_t i = first; i < last; ++i) absl::StrAppend(&content, " ", views[i]);
    std::array<unsigned char, SHA256_DIGEST_LENGTH> digest{};
    SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(), digest.data());
    out.push_back(absl::StrCat("archive-",
                               absl::BytesToHexString(absl::string_view(
                                   reinterpret_cast<const char*>(digest.data()), kUploadIdBytes))));
  }
  return out;
}

absl::StatusOr<ArchiveImportCounts> ImportArchive(Client& client, const OpenArchive& archive,
                                                  const ArchiveComparison& comparison,
                                                  const ArchiveImportOptions& options,
                                                  const UploadWatch& watch) {
  return ArchiveImport(client, archive, comparison, options, watch).Run();
}

}  // namespace graspdb::client
