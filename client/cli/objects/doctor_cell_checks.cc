// Cells whose camera or settings leave nothing to recognise.
#include <cmath>

#include "client/cli/objects/doctor_checks.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

// Half the angle that a wide depth camera sees, rad (Azure Kinect, wide: 60 degrees). Smaller,
// regions at the edge of its image are taken for invisible.
constexpr double kMaxViewAngle = 1.05;
// Points of the region along each side.
constexpr int kPointsPerSide = 9;
// No score is higher.
constexpr double kHighestScore = 1;

bool IsInView(const Eigen::Vector3d& point) {  // in the sensor frame
  return point.z() > 0 && std::atan2(std::hypot(point.x(), point.y()), point.z()) <= kMaxViewAngle;
}

bool IsSeen(const v1::AxisAlignedBox& region, const recognition::Pose& sensor_world) {
  const auto at = [](double min, double max, int step) {
    return min + (max - min) * step / (kPointsPerSide - 1);
  };
  for (int i = 0; i < kPointsPerSide * kPointsPerSide * kPointsPerSide; ++i) {
    const Eigen::Vector3d point(
        at(region.min().x(), region.max().x(), i % kPointsPerSide),
        at(region.min().y(), region.max().y(), i / kPointsPerSide % kPointsPerSide),
        at(region.min().z(), region.max().z(), i / kPointsPerSide / kPointsPerSide));
    if (IsInView(sensor_world * point)) return true;
  }
  return false;
}

}  // namespace

void CheckCameraView(const v1::Cell& cell, Findings* out) {
  if (!cell.has_sensor_pose() || !cell.has_region_of_interest()) return;
  const recognition::Pose world_sensor = files::FromMessage(cell.sensor_pose());
  if (IsSeen(cell.region_of_interest(), world_sensor.inverse())) return;
  AddError(out, cell.name(),
           "its camera does not see its region, so nothing is recognised; correct the region, or "
           "the sensor pose with: graspdb cells level");
}

void CheckMinScore(const v1::Cell& cell, Findings* out) {
  if (!cell.pipeline().has_min_score() || cell.pipeline().min_score() < kHighestScore) return;
  AddError(out, cell.name(),
           "its minimum score is 1, which no detection reaches, so nothing is recognised; lower "
           "it: graspdb cells set");
}

}  // namespace graspdb::client
