// The stable poses of a snapshot, each with its views.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "recognition/models/taught.h"

namespace graspdb::server {

using recognition::TaughtPoses;

// The stable pose's name in `{stable pose}/views/{view}`.
std::string PoseOfView(const std::string& view);

// Outcomes of the grasps of a stable pose, by their ids; grasps without outcomes are left out.
struct TaughtOutcomes {
  std::string stable_pose;  // name
  std::map<std::string, recognition::PickCounts> picks;
};

// The effects of one change on stable poses and their views.
struct TaughtPoseChange {
  // Written; their views and outcomes are taken from the previous ones.
  std::vector<recognition::TaughtStablePose> written;
  std::vector<std::string> deleted;  // names
  std::vector<std::shared_ptr<const recognition::TaughtView>> added_views;
  std::vector<std::string> removed_views;  // names
  std::vector<TaughtOutcomes> outcomes = {};
};

// `poses` after the change; unchanged ones are shared. A view that is removed and added is
// replaced. O(n log n) in the views of the stable poses that change.
TaughtPoses Changed(const TaughtPoses& poses, const TaughtPoseChange& change);

}  // namespace graspdb::server
