// The calibration target, and its detection in a scan. All functions are thread-safe.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/calibration/target/pose_certainty.h"
#include "client/cell/calibration/target/still_scan.h"
#include "client/sdk/client.h"
#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// A stable pose of an object, with its views fused.
struct Target {
  std::string stable_pose;                                 // resource name
  std::shared_ptr<const recognition::SurfaceModel> model;  // frame of the stable pose, metres
};

// Reads a target from the server: `objects/{object}` of an object with one stable pose, or
// `objects/{object}/stablePoses/{stable_pose}`. FAILED_PRECONDITION, with the next step, when there
// is none, when it has a rotational symmetry, or when its views were taught without object poses;
// otherwise the client's errors.
absl::StatusOr<Target> LoadTarget(Client& client, const std::string& name);

// The pose of a detected target.
struct DetectedTarget {
  recognition::Pose sensor_target = recognition::Pose::Identity();  // T_sensor_target
  Matrix6d covariance = UsualCovariance();                          // frame of the target
};

// Finds a target that stands on the table, by the server's recognition; the table defines the world
// frame. NOT_FOUND when it is not detected, detected more than once, or ambiguous; otherwise the
// client's errors.
absl::StatusOr<DetectedTarget> FindTargetOnTable(Client& client, const Target& target,
                                                 const StillScan& scan);

// Finds a gripped target above the table, in any orientation; locally, because the server
// recognises stable poses only. `world_sensor` is the levelled camera pose, `region` (world frame)
// contains the target; without it, anywhere up to a metre above the table. NOT_FOUND when it is not
// detected.
absl::StatusOr<DetectedTarget> FindGrippedTarget(const Target& target, const StillScan& scan,
                                                 const recognition::Pose& world_sensor,
                                                 const std::optional<recognition::Box>& region);

}  // namespace graspdb::client
