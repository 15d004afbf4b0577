#include "client/cell/calibration/pose_certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <numbers>

#include "recognition/base/units.h"
#include "recognition/points/voxels.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kVoxelM = 0.003;
constexpr float kOwnM = 0.004F;
// Of a voxel across the surface, m, and how many of them err together: so that what is expected of
// detections goes with how far they are off (docs/calibration.md).
constexpr double kPointDeviationM = 0.0012;
constexpr double kPointsThatErrTogether = 3;
// What the edges of an object hold.
constexpr double kEdgeShiftM = 0.0015;
constexpr double kEdgeTurnRad = 1.5 * recognition::kRadiansPerDegree;
// What a table under it holds.
constexpr double kTableHeightM = 0.0003;
constexpr double kTableTiltRad = 0.1 * recognition::kRadiansPerDegree;
// What is never better: the model, and the camera.
constexpr double kMinShiftM = 0.0002;
constexpr double kMinSpreadRad = 0.1 * recognition::kRadiansPerDegree;
// What is usual of detections and of robots.
constexpr double kUsualShiftM = 0.0005;
constexpr double kUsualTurnRad = 0.2 * recognition::kRadiansPerDegree;

Matrix6d Diagonal(double turn_rad, double shift_m) {
  Vector6d variances;
  variances << Vector3d::Constant(turn_rad * turn_rad), Vector3d::Constant(shift_m * shift_m);
  return variances.asDiagonal();
}

}  // namespace

Matrix6d CovarianceOf(const recognition::SurfaceModel& model, const recognition::Points& points,
                      const recognition::Pose& sensor_target, bool on_table) {
  const Eigen::Isometry3f target_sensor = sensor_target.inverse().cast<float>();
  recognition::Points own;
  for (const Vector3f& p : points) {
    const Vector3f q = target_sensor * p;
    if (q.allFinite() && model.DistanceTo(q) < kOwnM) own.push_back(q);
  }
  // Information about the target's frame, of which the origin is not far from its middle.
  Matrix6d information = Diagonal(1 / kEdgeTurnRad, 1 / kEdgeShiftM);
  const double weight = 1 / (kPointDeviationM * kPointDeviationM * kPointsThatErrTogether);
  for (const Vector3f& p : recognition::DownsampleToVoxels(own, kVoxelM).points) {
    const int nearest = model.grid.Nearest(p);
    if (nearest < 0) continue;
    const Vector3d normal =
        model.fine.cloud.normals[static_cast<std::size_t>(nearest)].cast<double>();
    Vector6d row;
    row << p.cast<double>().cross(normal), normal;
    information += weight * row * row.transpose();
  }
  if (on_table) {
    information(0, 0) += 1 / (kTableTiltRad * kTableTiltRad);
    information(1, 1) += 1 / (kTableTiltRad * kTableTiltRad);
    information(5, 5) += 1 / (kTableHeightM * kTableHeightM);
  }
  return Matrix6d(information.ldlt().solve(Matrix6d::Identity())) +
         Diagonal(kMinSpreadRad, kMinShiftM);
}

Matrix6d UsualCovariance() { return Diagonal(kUsualTurnRad, kUsualShiftM); }

}  // namespace graspdb::client
