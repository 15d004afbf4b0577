// Computes a turntable's axis from views of the object on it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// The cloud of an object after a turn.
struct TurnedCloud {
  double azimuth_rad = 0;            // counter-clockwise seen from above
  recognition::OrientedCloud cloud;  // world frame, m
};

struct SeenAxis {
  Eigen::Vector2d axis = Eigen::Vector2d::Zero();  // where it meets the table, world frame, m
  double deviation_m = 0;                          // of `axis`, in its least certain direction
  double rms_m = 0;  // distance of the points from the surface of the other views
  double share = 0;  // of the points on that surface, 0 to 1
};

// The axis that aligns neighbouring views best: the turns between them are known, so the axis is
// the minimum of the point-to-plane residuals (Y. Chen and G. Medioni, "Object modelling by
// registration of multiple range images", 1992). `start` is at most some 2 cm off. Deterministic;
// thread-safe.
//
// FAILED_PRECONDITION when too few views are less than 65 degrees apart, or the standard deviation
// of the axis is above a millimetre.
absl::StatusOr<SeenAxis> FindAxis(std::span<const TurnedCloud> views, const Eigen::Vector2d& start);

// The stored views of a stable pose (a resource name). Errors of the server.
absl::StatusOr<std::vector<TurnedCloud>> TaughtTurn(Client& client, const std::string& stable_pose);

}  // namespace graspdb::client
