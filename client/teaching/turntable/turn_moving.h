// Moving a turn that was taught about a wrong axis to the right one. All functions may be called
// from any thread, but not concurrently for one stable pose.
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

// Teaches the stored views of a stable pose (a resource name) again, with the object's origin above
// `axis` (world frame, m), and deletes the old ones. All are taught before the first is deleted:
// after an interruption no view is lost, and some exist twice. `region` is that of the cell. Errors
// of the server.
absl::Status MoveTurn(Client& client, const std::string& stable_pose, const Eigen::Vector2d& axis,
                      const std::optional<v1::AxisAlignedBox>& region);

// The views of a stable pose (a resource name) that are not of the turn at `origin` (world frame,
// m), as after an interrupted move; none if all are of that turn, or none is. Errors of the server.
absl::StatusOr<std::vector<v1::View>> LeftByMove(Client& client, const std::string& stable_pose,
                                                 const Eigen::Vector3d& origin);

// Prompts whether to delete the views of LeftByMove, and deletes them. Errors of the server.
absl::Status OfferToEndMove(Client& client, TeachingPrompt& prompt, const std::string& stable_pose,
                            const Eigen::Vector3d& origin);

}  // namespace graspdb::client
