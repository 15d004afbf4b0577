#include "client/cell/calibration/table_level.h"

#include <Eigen/Geometry>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_format.h"
#include "recognition/base/units.h"
#include "recognition/segmentation/region.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Pose;

constexpr double kRangeM = 1.5;
constexpr double kOnTableM = 0.006;
constexpr double kMinTableShare = 1.0 / 3;
constexpr double kMaxViewAngleRad = 75 * recognition::kRadiansPerDegree;
constexpr double kMaxTiltRad = 15 * recognition::kRadiansPerDegree;

double AngleBetween(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

absl::StatusOr<DetectedTable> FindTable(const recognition::Points& points) {
  recognition::Points near;
  for (const Eigen::Vector3f& p : points) {
    if (recognition::IsMeasurement(p) && p.norm() < static_cast<float>(kRangeM)) near.push_back(p);
  }
  recognition::PlaneConstraint constraint;
  constraint.distance_m = kOnTableM;
  constraint.min_share = kMinTableShare;
  const auto plane = recognition::FindPlane(near, Vector3d::Zero(), constraint);
  if (!plane) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "no plane has a third of the %d points within 1.5 m; clear the table and point the camera "
        "at it",
        near.size()));
  }
  DetectedTable out{.plane = *plane};
  double squares = 0;
  double count = 0;
  for (const Eigen::Vector3f& p : near) {
    const double height = plane->Height(p.cast<double>());
    if (std::abs(height) > kOnTableM) continue;
    squares += height * height;
    count += 1;
  }
  out.rms_m = std::sqrt(squares / count);
  out.share = count / static_cast<double>(near.size());
  const double view_angle = AngleBetween(plane->normal, -Vector3d::UnitZ());
  if (view_angle > kMaxViewAngleRad) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the largest plane is seen %.0f degrees from its normal, at most 75 are allowed; point the "
        "camera down at the table",
        view_angle / recognition::kRadiansPerDegree));
  }
  return out;
}

absl::StatusOr<Pose> LevelOn(const DetectedTable& table, const std::optional<Pose>& before) {
  if (!before) {
    const auto level = recognition::WorldFromPlane(table.plane, Vector3d::Zero(), Vector3d::UnitZ(),
                                                   Vector3d::UnitX());
    if (level) return *level;
    return absl::FailedPreconditionError(
        "the image's right points out of the table; turn the camera about its line of sight");
  }
  const Vector3d up = before->linear() * table.plane.normal;
  const double tilt = AngleBetween(up, Vector3d::UnitZ());
  if (tilt > kMaxTiltRad) {
    return absl::FailedPreconditionError(absl::StrFormat(
        "the plane is tilted by %.1f degrees against the cell's sensor pose, so it is not its "
        "table; clear the table, or correct the pose with `graspdb cells set`",
        tilt / recognition::kRadiansPerDegree));
  }
  Pose out = Pose::Identity();
  out.linear() = Eigen::Quaterniond::FromTwoVectors(up, Vector3d::UnitZ()).toRotationMatrix() *
                 before->linear();
  out.translation() = before->translation();
  out.translation().z() = table.plane.Height(Vector3d::Zero());
  return out;
}

LevelError LevelErrorOf(const DetectedTable& table, const Pose& world_sensor) {
  LevelError out;
  const recognition::Plane& plane = table.plane;
  out.tilt_rad = AngleBetween(world_sensor.linear() * plane.normal, Vector3d::UnitZ());
  // Where the middle of the image meets the plane.
  const double range = plane.offset / plane.normal.z();
  out.height_m = (world_sensor * Vector3d(0, 0, range)).z();
  return out;
}

}  // namespace graspdb::client
