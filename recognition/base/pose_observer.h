// What a recognition does with poses, step by step, for experiments.
#pragma once

#include <functional>
#include <span>
#include <string_view>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// The steps that leave fewer poses.
enum class PoseStep {
  kProposed,  // initial poses
  kKept,      // those that are refined
  kRefined,   // those that are left of them, as refined, the best first
};

enum class PoseSource {
  kSegment,  // the views that resemble a segment
  kImage,    // point pairs in the image
};

struct ObservedPose {
  std::string_view stable_pose;          // resource name, valid during the call
  Pose world_object = Pose::Identity();  // T_world_object
};

// Gets what one step leaves in one segment, or of one object in the image. Several threads call it
// at once, in any order.
using PoseObserver = std::function<void(PoseStep, PoseSource, std::span<const ObservedPose>)>;

}  // namespace graspdb::recognition
