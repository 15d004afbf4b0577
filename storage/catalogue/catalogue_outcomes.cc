// Outcomes of grasps.
#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "base/status_macros.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/change_log.h"
#include "storage/changes/requests.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

// The record of a stable pose, or an empty one.
absl::StatusOr<GraspOutcomesRecord> ReadOutcomes(const Database& database, std::string_view name) {
  auto record = ReadRecord<GraspOutcomesRecord>(database, name);
  if (!absl::IsNotFound(record.status())) return record;
  GraspOutcomesRecord none;
  none.set_name(std::string(name));
  return none;
}

absl::Status CheckAdded(const v1::GraspOutcomeCounts& added) {
  const auto [least, most] =
      std::minmax({added.picked_count(), added.missed_count(), added.slipped_count()});
  if (least >= 0 && most > 0) return absl::OkStatus();
  return absl::InvalidArgumentError("give at least one outcome, and no negative count");
}

absl::Status CheckGrasp(const v1::StablePose& stable_pose, const std::string& grasp_id) {
  const auto is_it = [&](const v1::Grasp& grasp) { return grasp.grasp_id() == grasp_id; };
  if (std::ranges::any_of(stable_pose.grasps(), is_it)) return absl::OkStatus();
  return absl::NotFoundError("the stable pose " + stable_pose.name() + " has no grasp '" +
                             grasp_id + "'; list its grasps");
}

v1::GraspOutcomeCounts& CountsOf(GraspOutcomesRecord& record, const std::string& grasp_id) {
  for (v1::GraspOutcomeCounts& counts : *record.mutable_counts()) {
    if (counts.grasp_id() == grasp_id) return counts;
  }
  v1::GraspOutcomeCounts& added = *record.add_counts();
  added.set_grasp_id(grasp_id);
  return added;
}

// The answer to an earlier request with this id, if any.
absl::StatusOr<std::optional<AddedOutcomes>> FindAdded(const Database& database,
                                                       const RequestKey& request,
                                                       const ChangeBatch& batch) {
  if (request.id.empty()) return std::nullopt;
  ASSIGN_OR_RETURN(const auto found,
                   FindRequest(database, request.id, request.content_digest, batch.time()));
  if (!found.has_value()) return std::nullopt;
  return AddedOutcomes{found->grasp_outcome_counts(), found->revision(), true};
}

void KeepAdded(const AddedOutcomes& added, const RequestKey& request, ChangeBatch& batch) {
  if (request.id.empty()) return;
  RequestRecord record;
  record.set_id(request.id);
  record.set_content_digest(request.content_digest);
  record.set_revision(added.revision);
  *record.mutable_grasp_outcome_counts() = added.counts;
  batch.KeepRequest(std::move(record));
}

}  // namespace

absl::StatusOr<AddedOutcomes> Catalogue::AddGraspOutcomes(std::string_view stable_pose_name,
                                                          const v1::GraspOutcomeCounts& added,
                                                          const RequestKey& request) {
  RETURN_IF_ERROR(CheckAdded(added));
  AddedOutcomes out;
  const absl::Status status = log_->Mutate([&](ChangeBatch& batch) -> absl::Status {
    ASSIGN_OR_RETURN(auto earlier, FindAdded(*database_, request, batch));
    if (earlier.has_value()) {
      out = *std::move(earlier);
      return absl::OkStatus();
    }
    ASSIGN_OR_RETURN(const auto pose, ReadRecord<v1::StablePose>(*database_, stable_pose_name));
    RETURN_IF_ERROR(CheckGrasp(pose, added.grasp_id()));
    ASSIGN_OR_RETURN(auto record, ReadOutcomes(*database_, stable_pose_name));
    v1::GraspOutcomeCounts& counts = CountsOf(record, added.grasp_id());
    counts.set_picked_count(counts.picked_count() + added.picked_count());
    counts.set_missed_count(counts.missed_count() + added.missed_count());
    counts.set_slipped_count(counts.slipped_count() + added.slipped_count());
    out = {counts, batch.Begin()};
    batch.Overwrite(Family::kGraspOutcomes, stable_pose_name, record.SerializeAsString());
    KeepAdded(out, request, batch);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<GraspOutcomesRecord> Catalogue::GetGraspOutcomes(
    std::string_view stable_pose_name) const {
  RETURN_IF_ERROR(GetStablePose(stable_pose_name).status());
  return ReadOutcomes(*database_, stable_pose_name);
}

}  // namespace graspdb::storage
