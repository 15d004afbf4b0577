#include "server/live/change_effects.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "program/log/log_field.h"
#include "server/live/records.h"
#include "server/requests/convert.h"
#include "storage/database/family.h"

namespace graspdb::server {
namespace {

bool IsTaughtView(const TaughtPoses& poses, const std::string& view_name) {
  const auto pose = poses.find(PoseOfView(view_name));
  if (pose == poses.end()) return false;
  const auto name = [](const auto& view) -> const std::string& { return view->name; };
  return std::ranges::binary_search(pose->second->views, view_name, {}, name);
}

TaughtOutcomes OutcomesFromRecord(const storage::GraspOutcomesRecord& record) {
  TaughtOutcomes out = {.stable_pose = record.name(), .picks = {}};
  for (const v1::GraspOutcomeCounts& counts : record.counts()) {
    out.picks[counts.grasp_id()] = {counts.picked_count(), counts.missed_count(),
                                    counts.slipped_count()};
  }
  return out;
}

bool IsPut(const storage::Mutation& mutation) {
  return mutation.kind() == storage::Mutation::KIND_PUT;
}

absl::StatusOr<recognition::IndexedView> ViewOf(
    const storage::Mutation& mutation, const recognition::DescriptorParameters& parameters) {
  storage::ViewRecord record;
  if (!record.ParseFromString(mutation.value())) {
    return absl::DataLossError("its record cannot be read");
  }
  return IndexedViewFromRecord(record, parameters);
}

void AddViewEffect(const storage::Mutation& mutation, const TaughtPoses& known,
                   const recognition::DescriptorParameters& parameters, Effects* out) {
  out->touched.push_back(mutation.key());
  if (IsTaughtView(known, mutation.key())) out->removed.insert(mutation.key());
  if (!IsPut(mutation)) return;
  absl::StatusOr<recognition::IndexedView> view = ViewOf(mutation, parameters);
  if (view.ok()) {
    out->added.push_back(*std::move(view));
    return;
  }
  LogLeftOut(mutation.key(), view.status());
  out->left_out.push_back(mutation.key());
}

// The views of a stable pose that cannot be used still refer to it.
void AddStablePose(const std::string& name, absl::StatusOr<recognition::TaughtStablePose> pose,
                   TaughtPoseChange* poses, std::vector<std::string>* left_out) {
  if (!pose.ok()) {
    LogLeftOut(name, pose.status());
    left_out->push_back(name);
    pose.emplace();
    pose->name = name;
  }
  poses->written.push_back(*std::move(pose));
}

void AddStablePoseEffect(const storage::Mutation& mutation, Effects* out) {
  out->touched.push_back(mutation.key());
  if (!IsPut(mutation)) {
    out->poses.deleted.push_back(mutation.key());
    return;
  }
  v1::StablePose record;
  const bool readable = record.ParseFromString(mutation.value());
  AddStablePose(
      mutation.key(),
      readable ? StablePoseFromProto(record) : absl::DataLossError("unreadable stable pose"),
      &out->poses, &out->left_out);
}

void AddOutcomesEffect(const storage::Mutation& mutation, Effects* out) {
  storage::GraspOutcomesRecord record;
  if (IsPut(mutation) && !record.ParseFromString(mutation.value())) {
    LogLeftOut(mutation.key(), absl::DataLossError("unreadable outcomes"));
    return;
  }
  record.set_name(mutation.key());
  out->poses.outcomes.push_back(OutcomesFromRecord(record));
}

}  // namespace

Effects EffectsOf(const storage::ChangeRecord& change, const TaughtPoses& known,
                  const recognition::DescriptorParameters& parameters) {
  Effects out;
  for (const storage::Mutation& mutation : change.mutations()) {
    const std::string& family = mutation.column_family();
    if (family == storage::FamilyName(storage::Family::kViews)) {
      AddViewEffect(mutation, known, parameters, &out);
    } else if (family == storage::FamilyName(storage::Family::kStablePoses)) {
      AddStablePoseEffect(mutation, &out);
    } else if (family == storage::FamilyName(storage::Family::kGraspOutcomes)) {
      AddOutcomesEffect(mutation, &out);
    }
  }
  out.poses.removed_views.assign(out.removed.begin(), out.removed.end());
  for (const auto& added : out.added) out.poses.added_views.push_back(added.view);
  return out;
}

storage::RecordVisitor StablePoseVisitor(TaughtPoseChange* poses,
                                         std::vector<std::string>* left_out) {
  storage::RecordVisitor visitor;
  visitor.stable_pose = [=](const v1::StablePose& record) {
    AddStablePose(record.name(), StablePoseFromProto(record), poses, left_out);
    return absl::OkStatus();
  };
  visitor.grasp_outcomes = [=](const storage::GraspOutcomesRecord& record) {
    poses->outcomes.push_back(OutcomesFromRecord(record));
    return absl::OkStatus();
  };
  return visitor;
}

void LogLeftOut(const std::string& name, const absl::Status& why) {
  spdlog::error("event=record_left_out name={} error={}", LogField(name),
                LogField(std::string(why.message())));
}

}  // namespace graspdb::server
