// A turn that was taught about a wrong axis, put about the right one.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "absl/status/status.h"
#include "client/api/client.h"

namespace graspdb::client {

// Teaches the views of a stable pose (a resource name) again as the server keeps them, with the
// object's origin above `axis` (world frame, m), and deletes those that were there. All are taught
// before the first one is deleted: broken off, no view is lost, and some are there twice. `region`
// is that of the cell. Errors of the server.
absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region);

}  // namespace graspdb::client
