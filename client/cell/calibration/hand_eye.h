// Hand-eye calibration from robot poses and the target poses measured at each of them.
#pragma once

#include <span>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/calibration/target/pose_certainty.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// A pose of the robot, and the target pose measured there.
struct HandEyeSample {
  recognition::Pose base_flange = recognition::Pose::Identity();
  recognition::Pose camera_target = recognition::Pose::Identity();
  Matrix6d covariance = UsualCovariance();  // of camera_target, in the frame of the target
};

enum class CameraMount {
  kFixed,    // beside the robot; the target is in the gripper
  kOnFlange  // the target stands still
};

// The residual of one sample.
struct HandEyeResidual {
  double shift_m = 0;
  double turn_rad = 0;
  bool used = true;  // false: outlier, left out
};

// How far a calibration can be trusted.
struct HandEyeCertainty {
  // Standard deviation of the camera's position in the direction that the poses show worst, m.
  double weakest_m = 0;
  // Root mean square error of each sample used under the calibration by the others.
  double left_out_shift_m = 0;
  double left_out_turn_rad = 0;
};

struct HandEye {
  // T_base_camera of a fixed camera, T_flange_camera of one on the flange.
  recognition::Pose mount_camera = recognition::Pose::Identity();
  // T_flange_target for a target in the gripper, T_base_target for a fixed one.
  recognition::Pose mount_target = recognition::Pose::Identity();
  std::vector<HandEyeResidual> residuals;  // of the samples, in their order
  double shift_m = 0;                      // root mean square of those used
  double turn_rad = 0;
  HandEyeCertainty certainty = {};
};

// Fewer samples are not accepted.
inline constexpr std::size_t kMinHandEyeSamples = 6;

// Solves A_i Y = X B_i for the camera X and the target Y at once: rotations by the singular vectors
// of the sum of Kronecker products, then translations, after Shah, "Solving the Robot-World/
// Hand-Eye Calibration Problem Using the Kronecker Product", ASME J. Mechanisms and Robotics 5(3),
// 2013; on many small subsets of the samples, because some may be outliers, and then by
// Gauss-Newton over all inliers. Deterministic. FAILED_PRECONDITION when there are too few samples,
// when the robot turned about one axis only or hardly at all, when its positions cannot be a
// flange's in metres or do not fit in scale, when they leave the camera's position uncertain, or
// when fewer than half of the samples, or too few, agree.
absl::StatusOr<HandEye> SolveHandEye(std::span<const HandEyeSample> samples, CameraMount mount);

// Residuals of other samples under an existing calibration, given by its camera and target.
std::vector<HandEyeResidual> CheckHandEye(std::span<const HandEyeSample> samples, CameraMount mount,
                                          const recognition::Pose& mount_camera,
                                          const recognition::Pose& mount_target);

}  // namespace graspdb::client
