// Where a turntable's axis is, from what a camera saw of the object on it.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/sdk/client.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// What was seen of an object after a turn.
struct TurnedCloud {
  double azimuth_rad = 0;            // counter-clockwise seen from above
  recognition::OrientedCloud cloud;  // world frame, m
};

struct SeenAxis {
  Eigen::Vector2d axis = Eigen::Vector2d::Zero();  // where it meets the table, world frame, m
  double deviation_m = 0;                          // of `axis`, in its least certain direction
  double rms_m = 0;  // of the points from the surface that the other views saw there
  double share = 0;  // of the points that lie on it, 0 to 1
};

// The axis about which neighbouring views lie on each other best: the turns between them are known,
// so that points of one and tangent planes of the other (Y. Chen and G. Medioni, "Object modelling
// by registration of multiple range images", 1992) say where the axis is, beginning at `start`,
// some 2 cm from it at the most. Deterministic; thread-safe.
//
// FAILED_PRECONDITION when too few views are less than 65 degrees apart, or their surfaces leave
// the axis open by more than a millimetre.
absl::StatusOr<SeenAxis> FindAxis(std::span<const TurnedCloud> views, const Eigen::Vector2d& start);

// The views of a stable pose (a resource name) as the server keeps them. Errors of the server.
absl::StatusOr<std::vector<TurnedCloud>> TaughtTurn(Client& client, const std::string& stable_pose);

}  // namespace graspdb::client
