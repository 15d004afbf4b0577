// A turn that was taught about a wrong axis, put about the right one. All functions may be called
// from any thread, for one stable pose by one at a time.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "client/teaching/turntable/teaching_prompt.h"

namespace graspdb::client {

// Teaches the views of a stable pose (a resource name) again as the server keeps them, with the
// object's origin above `axis` (world frame, m), and deletes those that were there. All are taught
// before the first one is deleted: broken off, no view is lost, and some are there twice. `region`
// is that of the cell. Errors of the server.
absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region);

// The views of a stable pose (a resource name) that are not of the turn at `origin` (world frame,
// m), as a move that was broken off leaves them; none where all are of that turn, or none is.
// Errors of the server.
absl::StatusOr<std::vector<v1::View>> LeftByMove(Client& client, const std::string& stable_pose,
                                                 const Eigen::Vector3d& origin);

// Asks whether the views that are LeftByMove are to be deleted, and does that. Errors of the
// server.
absl::Status OfferToEndMove(Client& client, TeachingPrompt& prompt, const std::string& stable_pose,
                            const Eigen::Vector3d& origin);

}  // namespace graspdb::client
