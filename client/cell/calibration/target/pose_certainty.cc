#include "client/cell/calibration/target/pose_certainty.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "recognition/base/units.h"
#include "recognition/points/voxels.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kVoxelM = 0.003;
constexpr float kOwnM = 0.004F;
// Deviation of a voxel along its normal, m, and number of voxels with correlated errors: fitted so
// that predicted and measured detection errors agree (docs/calibration.md).
constexpr double kVoxelDeviationM = 0.0012;
constexpr double kCorrelatedVoxels = 3;
// Deviations allowed by the edges of an object.
constexpr double kEdgeShiftM = 0.0015;
constexpr double kEdgeTurnRad = 1.5 * recognition::kRadiansPerDegree;
// Deviations allowed by the table under it.
constexpr double kTableHeightM = 0.0003;
constexpr double kTableTiltRad = 0.1 * recognition::kRadiansPerDegree;
// Lower bounds, from errors of model and camera.
constexpr double kMinShiftM = 0.0002;
constexpr double kMinSpreadRad = 0.1 * recognition::kRadiansPerDegree;
// Typical deviations of detections and robots.
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
  // Information matrix in the target's frame, whose origin is near its centre.
  Matrix6d information = Diagonal(1 / kEdgeTurnRad, 1 / kEdgeShiftM);
  const double weight = 1 / (kVoxelDeviationM * kVoxelDeviationM * kCorrelatedVoxels);
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
