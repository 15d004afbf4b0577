#include "client/cell/robots/pose_format.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using recognition::kDegreesPerRadian;
using recognition::kMmPerM;
using recognition::Pose;

// A quaternion that was rounded to six decimals is of length one within a few of them.
constexpr double kLengthTolerance = 0.01;
// Below this, first and last axis coincide (gimbal lock).
constexpr double kLocked = 1e-9;

// In the order of the codes.
constexpr std::array<std::array<int, 3>, 12> kSequences = {{{0, 1, 2},
                                                            {0, 2, 1},
                                                            {1, 0, 2},
                                                            {1, 2, 0},
                                                            {2, 0, 1},
                                                            {2, 1, 0},
                                                            {0, 1, 0},
                                                            {0, 2, 0},
                                                            {1, 0, 1},
                                                            {1, 2, 1},
                                                            {2, 0, 2},
                                                            {2, 1, 2}}};

constexpr int kFirstEulerFormat = 4;

// Three turns, each about an axis as already turned (intrinsic): R = R_axis0 R_axis1 R_axis2.
struct EulerFormat {
  std::array<int, 3> axes = {};  // 0: x, 1: y, 2: z
  bool backward = false;         // the last turn is written first
  bool radians = false;          // else degrees
};

EulerFormat EulerFormatOf(int code) {
  const int place = code - kFirstEulerFormat;
  return {.axes = kSequences[static_cast<std::size_t>(place / 4)],
          .backward = place % 4 >= 2,
          .radians = RotationUnitOf(code) == RotationUnit::kRadians};
}

absl::Status NoSuchFormat(int code) {
  return absl::InvalidArgumentError(
      absl::StrCat("there is no pose format ", code, "; formats are 1 to ", kLastPoseFormat));
}

bool IsFormat(int code) { return code >= kQuaternionWxyz && code <= kLastPoseFormat; }

Matrix3d TurnAbout(int axis, double angle) {
  return AngleAxisd(angle, Vector3d::Unit(axis)).toRotationMatrix();
}

// The angles of R = R_i R_j R_k or R_i R_j R_i, in radians. The entries of such a product are
// products of sines and cosines; `sign` is -1 where i, j, k are not in the order x, y, z, x, y.
Vector3d EulerAngles(const Matrix3d& r, const std::array<int, 3>& axes) {
  const int i = axes[0];
  const int j = axes[1];
  const int k = 3 - i - j;
  const double sign = (j - i + 3) % 3 == 1 ? 1 : -1;
  const bool two_axes = axes[2] == i;
  const double near_lock = two_axes ? std::hypot(r(i, j), r(i, k)) : std::hypot(r(i, i), r(i, j));
  const double middle =
      two_axes ? std::atan2(near_lock, r(i, i)) : std::atan2(sign * r(i, k), near_lock);
  if (near_lock < kLocked) return {std::atan2(sign * r(k, j), r(j, j)), middle, 0};
  if (two_axes) {
    return {std::atan2(r(j, i), -sign * r(k, i)), middle, std::atan2(r(i, j), sign * r(i, k))};
  }
  return {std::atan2(-sign * r(j, k), r(k, k)), middle, std::atan2(-sign * r(i, j), r(i, i))};
}

std::array<double, 4> EulerNumbers(const Matrix3d& rotation, const EulerFormat& format) {
  Vector3d angles = EulerAngles(rotation, format.axes);
  if (!format.radians) angles *= kDegreesPerRadian;
  if (format.backward) std::swap(angles[0], angles[2]);
  return {angles[0], angles[1], angles[2], 0};
}

Matrix3d EulerRotation(const std::array<double, 4>& numbers, const EulerFormat& format) {
  Vector3d angles(numbers[0], numbers[1], numbers[2]);
  if (!format.radians) angles /= kDegreesPerRadian;
  if (format.backward) std::swap(angles[0], angles[2]);
  return TurnAbout(format.axes[0], angles[0]) * TurnAbout(format.axes[1], angles[1]) *
         TurnAbout(format.axes[2], angles[2]);
}

std::array<double, 4> RotationNumbers(const Matrix3d& rotation, int code) {
  if (code >= kFirstEulerFormat) return EulerNumbers(rotation, EulerFormatOf(code));
  Quaterniond q(rotation);
  q.normalize();
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  if (code == kQuaternionWxyz) return {q.w(), q.x(), q.y(), q.z()};
  if (code == kQuaternionXyzw) return {q.x(), q.y(), q.z(), q.w()};
  const Vector3d vector = RotationVector(rotation);
  return {vector.x(), vector.y(), vector.z(), 0};
}

absl::StatusOr<Matrix3d> RotationOf(const std::array<double, 4>& numbers, int code) {
  if (code >= kFirstEulerFormat) return EulerRotation(numbers, EulerFormatOf(code));
  if (code == kRotationVector) {
    return FromRotationVector({numbers[0], numbers[1], numbers[2]});
  }
  const auto& n = numbers;
  Quaterniond q = code == kQuaternionWxyz ? Quaterniond(n[0], n[1], n[2], n[3])
                                          : Quaterniond(n[3], n[0], n[1], n[2]);
  if (std::abs(q.norm() - 1) > kLengthTolerance) {
    return absl::InvalidArgumentError(absl::StrCat("the quaternion's length is ", q.norm(),
                                                   ", not 1; is the pose format right?"));
  }
  return q.normalized().toRotationMatrix();
}

}  // namespace

RotationUnit RotationUnitOf(int code) {
  if (code == kQuaternionWxyz || code == kQuaternionXyzw) return RotationUnit::kQuaternion;
  return code % 2 == 1 ? RotationUnit::kRadians : RotationUnit::kDegrees;
}

absl::StatusOr<RobotPose> ToRobotPose(const Pose& pose, int code) {
  if (!IsFormat(code)) return NoSuchFormat(code);
  RobotPose out;
  for (std::size_t i = 0; i < 3; ++i) {
    out.position_mm[i] = kMmPerM * pose.translation()[static_cast<Eigen::Index>(i)];
  }
  out.rotation = RotationNumbers(pose.linear(), code);
  return out;
}

absl::StatusOr<Pose> FromRobotPose(const RobotPose& numbers, int code) {
  if (!IsFormat(code)) return NoSuchFormat(code);
  const auto is_finite = [](double number) { return std::isfinite(number); };
  if (!std::ranges::all_of(numbers.position_mm, is_finite) ||
      !std::ranges::all_of(numbers.rotation, is_finite)) {
    return absl::InvalidArgumentError("the pose has numbers that are not finite");
  }
  ASSIGN_OR_RETURN(const Matrix3d rotation, RotationOf(numbers.rotation, code));
  Pose out = Pose::Identity();
  out.linear() = rotation;
  const auto& p = numbers.position_mm;
  out.translation() = Vector3d(p[0], p[1], p[2]) / kMmPerM;
  return out;
}

}  // namespace graspdb::client
