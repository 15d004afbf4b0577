#include "storage/changes/grasp_outcomes.h"

#include <string>

#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

const v1::Grasp* FindGrasp(const v1::StablePose& stable_pose, const std::string& grasp_id) {
  for (const v1::Grasp& grasp : stable_pose.grasps()) {
    if (grasp.grasp_id() == grasp_id) return &grasp;
  }
  return nullptr;
}

// The fields that decide whether a pick succeeds: tool pose, opening and free turn.
std::string GeometryOf(const v1::Grasp& grasp) {
  v1::Grasp geometry;
  geometry.set_gripper_opening_m(grasp.gripper_opening_m());
  if (grasp.has_tcp_pose()) *geometry.mutable_tcp_pose() = grasp.tcp_pose();
  if (grasp.has_free_turn()) *geometry.mutable_free_turn() = grasp.free_turn();
  return geometry.SerializeAsString();
}

bool IsSameGrasp(const v1::Grasp* before, const v1::Grasp* after) {
  return before != nullptr && after != nullptr && GeometryOf(*before) == GeometryOf(*after);
}

}  // namespace

absl::Status ForgetChangedGrasps(const Database& database, ChangeBatch& batch,
                                 const v1::StablePose& before, const v1::StablePose& after) {
  const auto outcomes = ReadRecord<GraspOutcomesRecord>(database, before.name());
  if (absl::IsNotFound(outcomes.status())) return absl::OkStatus();
  if (!outcomes.ok()) return outcomes.status();
  GraspOutcomesRecord kept;
  kept.set_name(outcomes->name());
  for (const v1::GraspOutcomeCounts& counts : outcomes->counts()) {
    const std::string& id = counts.grasp_id();
    if (IsSameGrasp(FindGrasp(before, id), FindGrasp(after, id))) *kept.add_counts() = counts;
  }
  if (kept.counts_size() == outcomes->counts_size()) return absl::OkStatus();
  if (kept.counts().empty()) {
    batch.Remove(Family::kGraspOutcomes, before.name(), outcomes->SerializeAsString());
  } else {
    batch.Overwrite(Family::kGraspOutcomes, before.name(), kept.SerializeAsString());
  }
  return absl::OkStatus();
}

absl::Status RemoveGraspOutcomes(const Database& database, ChangeBatch& batch,
                                 std::string_view stable_pose_name) {
  const auto outcomes = database.Get(Family::kGraspOutcomes, stable_pose_name);
  if (absl::IsNotFound(outcomes.status())) return absl::OkStatus();
  if (!outcomes.ok()) return outcomes.status();
  batch.Remove(Family::kGraspOutcomes, stable_pose_name, *outcomes);
  return absl::OkStatus();
}

}  // namespace graspdb::storage
