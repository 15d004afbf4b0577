// The object by which a camera is calibrated, and where it is in a scan. All functions are
// thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/calibration/pose_certainty.h"
#include "client/cell/calibration/still_scan.h"
#include "client/sdk/client.h"
#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// A stable pose of an object, with its views fused.
struct Target {
  std::string stable_pose;                                 // resource name
  std::shared_ptr<const recognition::SurfaceModel> model;  // frame of the stable pose, metres
};

// Asks the server for a target: `objects/{object}` of an object with one stable pose, or
// `objects/{object}/stablePoses/{stable_pose}`. FAILED_PRECONDITION with what to do when there is
// none, when it looks the same after a turn, or when its views do not say where the object was;
// else the client's errors.
absl::StatusOr<Target> LoadTarget(Client& client, const std::string& name);

// Where a target was seen.
struct SeenTarget {
  recognition::Pose sensor_target = recognition::Pose::Identity();  // T_sensor_target
  Matrix6d covariance = UsualCovariance();                          // frame of the target
};

// A target that stands on the table before the camera, as the server recognises
// it; the table makes the world frame. NOT_FOUND when it is not seen, more than once, or as
// something that may be turned otherwise; else the client's errors.
absl::StatusOr<SeenTarget> FindStandingTarget(Client& client, const Target& target,
                                              const StillScan& scan);

// A target that a gripper holds above the table: whatever orientation it has, which
// no server is asked for, because objects stand upright there. `world_sensor` is the level of the
// camera, `region` (world frame) where the target is held; without it, anywhere up to a metre above
// the table. NOT_FOUND when it is not seen.
absl::StatusOr<SeenTarget> FindGrippedTarget(const Target& target, const StillScan& scan,
                                             const recognition::Pose& world_sensor,
                                             const std::optional<recognition::Box>& region);

}  // namespace graspdb::client
