#include "lab/experiment/pose_stages.h"

#include <algorithm>

#include "lab/experiment/gallery.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;
using recognition::PoseSource;
using recognition::PoseStep;

// A pose is at the place of an object whose centre is nearer than this share of the diameter. At
// other places the scan may show the object again.
constexpr double kPlaceShare = 0.5;

bool IsAtPlace(const rendering::MeasuredShape& shape, const Pose& a, const Pose& b) {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  for (const auto& p : shape.points) center += p.cast<double>();
  center /= static_cast<double>(shape.points.size());
  return (a * center - b * center).norm() < kPlaceShare * shape.diameter_m;
}

PoseStage StageOf(PoseStep step) {
  switch (step) {
    case PoseStep::kProposed:
      return PoseStage::kProposed;
    case PoseStep::kKept:
      return PoseStage::kKept;
    case PoseStep::kRefined:
      return PoseStage::kRefined;
  }
  return PoseStage::kNone;
}

}  // namespace

const char* TextOf(PoseStage stage) {
  switch (stage) {
    case PoseStage::kNone:
      return "nothing";
    case PoseStage::kProposed:
      return "proposed";
    case PoseStage::kKept:
      return "kept";
    case PoseStage::kRefined:
      return "refined";
    case PoseStage::kBest:
      return "best of its object";
    case PoseStage::kAccepted:
      return "accepted";
  }
  return "";
}

PoseStage After(PoseStage stage) { return static_cast<PoseStage>(static_cast<int>(stage) + 1); }

PoseRecord::PoseRecord(const PartSet& set, const std::vector<std::string>& object_ids) : set_(set) {
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    if (std::ranges::find(object_ids, set.parts[i].object_id) == object_ids.end()) continue;
    parts_[StablePoseName(set.parts[i])] = i;
  }
}

recognition::PoseObserver PoseRecord::Observer() {
  return
      [this](PoseStep step, PoseSource source, std::span<const recognition::ObservedPose> poses) {
        Step seen{step, source, {}};
        for (const recognition::ObservedPose& pose : poses) {
          const auto part = parts_.find(pose.stable_pose);
          if (part != parts_.end()) seen.poses.push_back({part->second, pose.world_object});
        }
        if (seen.poses.empty()) return;
        const std::lock_guard lock(mutex_);
        steps_.push_back(std::move(seen));
      };
}

PoseStage PoseRecord::StageOf(const std::string& object_id, const Pose& world_mesh,
                              PoseSource source) const {
  PoseStage furthest = PoseStage::kNone;
  for (const Step& step : steps_) {
    const PoseStage stage = lab::StageOf(step.step);
    const bool refined = stage == PoseStage::kRefined;
    if (step.source != source || (stage <= furthest && !refined)) continue;
    bool is_best = refined;
    for (const auto& [part, world_object] : step.poses) {
      const rendering::MeasuredShape& shape = *set_.shapes[part];
      if (set_.parts[part].object_id != object_id ||
          !IsAtPlace(shape, world_object, world_mesh * set_.object_mesh[part].inverse())) {
        continue;
      }
      if (ShareOff(set_, part, world_object, world_mesh) < (refined ? kFoundShare : kNearShare)) {
        furthest = std::max(furthest, is_best ? PoseStage::kBest : stage);
        break;
      }
      is_best = false;
    }
  }
  return furthest;
}

double ShareOff(const PartSet& set, std::size_t position, const Pose& world_object,
                const Pose& world_mesh) {
  const rendering::MeasuredShape& shape = *set.shapes[position];
  return rendering::AddS(shape, world_mesh * set.object_mesh[position].inverse(), world_object) /
         shape.diameter_m;
}

}  // namespace graspdb::lab
