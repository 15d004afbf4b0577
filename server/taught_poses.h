// The stable poses of a snapshot, each with its views.
#pragma once

#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

#include "recognition/taught.h"

namespace graspdb::server {

using TaughtPoses =
    std::unordered_map<std::string, std::shared_ptr<const recognition::TaughtStablePose>>;

// The stable pose's name in `{stable pose}/views/{view}`.
std::string PoseOfView(const std::string& view);

// What one change does to stable poses and their views.
struct TaughtPoseChange {
  // Written; their views are taken from what there was.
  std::vector<recognition::TaughtStablePose> written;
  std::vector<std::string> deleted;  // names
  std::vector<std::shared_ptr<const recognition::TaughtView>> added_views;
  std::vector<std::string> removed_views;  // names
};

// `poses` after the change; what does not change is shared. A view that is removed and added is
// replaced.
TaughtPoses Changed(const TaughtPoses& poses, const TaughtPoseChange& change);

}  // namespace graspdb::server
