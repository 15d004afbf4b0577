#include "recognition/matching/refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "recognition/simd/kernels.h"
#include "recognition/simd/rigid_transform.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3f;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Standard deviation of a voxel's place across the surface, m, relative to which the priors are
// weighted. Chosen; not measured alone. Doubled, the priors count four times.
constexpr double kPointDeviationM = 0.0012;
// Errors of scan points are correlated: this many count as one against a prior. Chosen; not
// measured alone. Doubled, the priors count half.
constexpr double kCorrelatedPoints = 30;
// Surfaces whose normals have a smaller cosine do not correspond: 60 degrees. Chosen; not measured
// alone. Twice as far from 1, at 90 degrees, points of two faces of a corner correspond.
constexpr float kMinAgreement = 0.5F;
// Weight of the distance along a surface that has ended, against that across it. Chosen: with 1 and
// 3 five to eight of 1050 poses are off, with this one eight (ADR 19, before recentring). Doubled,
// edges count twice.
constexpr float kEdgeWeight = 0.3F;
// Cosine between normal and ray from which on a surface counts as facing: 78 degrees. Chosen; not
// measured alone. Doubled, at 66 degrees, edges of steep faces have no residual.
constexpr float kMinFacing = 0.2F;
// Shorter moves, m at the model's rim, end the refinement once the reach is the last. Chosen, far
// below the mean errors, 0.1 mm and more. Doubled, it ends as early or earlier.
constexpr double kNegligibleMoveM = 2e-5;
// The same for what is reported as converged: a fifth of the mean error.
constexpr double kConvergedM = 1e-4;
// A measured table is more accurate than a calibration: share of its deviations. With 1, and the
// table of the calibration, mean errors are 0.356 degrees and 0.497 mm in place of 0.34 and 0.48
// (docs/experiment.md). Doubled, the table counts a quarter.
constexpr double kMeasuredTableShare = 0.25;

// The normal equations of one step: a turn about `center` and then a move, world frame.
class Step {
 public:
  // Sums about the center, in a frame that `world_sums` turns into that of the world.
  void Add(const simd::NormalEquations& sums, const Eigen::Matrix3d& world_sums, double share) {
    Matrix6d turn = Matrix6d::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = world_sums;
    Matrix6d hessian;
    const float* next = sums.hessian;
    for (int i = 0; i < 6; ++i) {
      for (int j = i; j < 6; ++j) hessian(i, j) = hessian(j, i) = static_cast<double>(*next++);
    }
    hessian_ += share * turn * hessian * turn.transpose();
    gradient_ +=
        share * turn * Eigen::Map<const Eigen::Matrix<float, 6, 1>>(sums.gradient).cast<double>();
    weight_ += share * static_cast<double>(sums.weight);
  }

  void AddPrior(int parameter, double value, double deviation) {
    const double ratio = kPointDeviationM / deviation;
    const double weight = ratio * ratio * std::max(1.0, weight_ / kCorrelatedPoints);
    hessian_(parameter, parameter) += weight;
    gradient_(parameter) += weight * value;
  }

  bool is_empty() const { return weight_ <= 0; }
  const Matrix6d& hessian() const { return hessian_; }

  Vector6d Solve() const {
    Matrix6d damped = hessian_;
    damped.diagonal().array() += 1e-9 * std::max(1.0, weight_);
    return damped.ldlt().solve(gradient_);
  }

 private:
  Matrix6d hessian_ = Matrix6d::Zero();
  Vector6d gradient_ = Vector6d::Zero();
  double weight_ = 0;
};

void AddScan(const SurfaceModel& model, const RefinementTarget& target, const Pose& world_object,
             float reach, Step* step) {
  simd::PointToPlaneResiduals residuals;
  residuals.from = target.columns.coordinates();
  residuals.to_from = RigidTransform(world_object.inverse()).rigid();
  residuals.to = model.look_up();
  Eigen::Map<Vector3f>(residuals.center) = model.center;
  residuals.reach = reach;
  residuals.spacing = kSurfaceSpacingM;
  residuals.edge_weight = kEdgeWeight;
  residuals.min_agreement = kMinAgreement;
  step->Add(simd::Best().accumulate_point_to_plane(residuals), world_object.linear(), 1);
}

// The model's edges that the camera would see and that reach beyond the scan; each counts `share`.
void AddEdges(const Surface& surface, const RefinementTarget& target, const Pose& world_object,
              const Vector3f& center, float reach, double share, Step* step) {
  simd::EdgeResiduals residuals;
  residuals.surface = surface.columns.coordinates();
  residuals.scan_surface = RigidTransform(world_object).rigid();
  residuals.sensor_surface = RigidTransform(Eigen::Isometry3f(target.depth_buffer.sensor_world() *
                                                              world_object.cast<float>()))
                                 .rigid();
  residuals.scan = target.grid.LookUpIn(target.cloud);
  residuals.window = target.depth_buffer.window();
  Eigen::Map<Vector3f>(residuals.center) = center;
  residuals.reach = reach;
  residuals.spacing = kSurfaceSpacingM;
  residuals.min_facing = kMinFacing;
  residuals.min_agreement = kMinAgreement;
  step->Add(simd::Best().accumulate_edges(residuals), Eigen::Matrix3d::Identity(),
            static_cast<double>(kEdgeWeight) * share);
}

void AddTable(const SurfaceModel& model, const std::optional<Plane>& measured,
              const Pose& world_object, const Vector3f& center, const RefinementOptions& options,
              Step* step) {
  const Plane table = measured.value_or(Plane());
  const double share = measured ? kMeasuredTableShare : 1;
  const Eigen::Vector3d off = world_object.linear().col(2) - table.normal;
  step->AddPrior(0, off.y(), share * options.tilt_deviation_rad);
  step->AddPrior(1, -off.x(), share * options.tilt_deviation_rad);
  const double lifted = table.Height(center.cast<double>()) - static_cast<double>(model.center.z());
  step->AddPrior(5, -lifted, share * options.height_deviation_m);
}

// The step from `world_object`, with correspondences up to `reach` apart.
Step StepFrom(const SurfaceModel& model, const RefinementTarget& target, const Pose& world_object,
              double reach, const RefinementOptions& options) {
  const Surface& surface = options.coarse ? model.coarse : model.fine;
  // Points of the model count for as much area as those of the scan.
  const double density = static_cast<double>(surface.spacing_m / kSurfaceSpacingM);
  const double edge_share = density * density / static_cast<double>(target.columns.stride());
  const Vector3f center = (world_object * model.center.cast<double>()).cast<float>();
  Step out;
  AddScan(model, target, world_object, static_cast<float>(reach), &out);
  if (options.edges)
    AddEdges(surface, target, world_object, center, static_cast<float>(reach), edge_share, &out);
  if (target.on_table && !out.is_empty()) {
    AddTable(model, target.table, world_object, center, options, &out);
  }
  return out;
}

}  // namespace

Refinement Refine(const SurfaceModel& model, const RefinementTarget& target, const Pose& initial,
                  const RefinementOptions& options, const IsKnown& is_known) {
  Refinement out{initial};
  if (target.cloud.points.empty() || model.fine.cloud.points.empty()) return out;
  Pose& pose = out.world_object;
  const double shrink =
      options.iterations > 1
          ? std::pow(options.last_reach_m / options.first_reach_m, 1.0 / (options.iterations - 1))
          : 1;
  double reach = options.first_reach_m;
  while (out.iterations < options.iterations) {
    const Step step = StepFrom(model, target, pose, reach, options);
    if (step.is_empty()) return out;
    const Vector6d move = step.Solve();
    pose = Moved(pose, pose * model.center.cast<double>(), move);
    ++out.iterations;
    const double moved =
        move.tail<3>().norm() + move.head<3>().norm() * static_cast<double>(model.radius_m);
    out.converged = moved < kConvergedM;
    if (moved < kNegligibleMoveM && reach <= 1.01 * options.last_reach_m) break;
    if (is_known && out.iterations < options.iterations && is_known(pose)) {
      out.stopped = true;
      return out;
    }
    reach *= shrink;
  }
  return out;
}

InformationMatrix InformationMatrixOf(const SurfaceModel& model, const RefinementTarget& target,
                                      const Pose& world_object) {
  const RefinementOptions options;
  return StepFrom(model, target, world_object, options.last_reach_m, options).hessian();
}

Pose Moved(const Pose& world_object, const Eigen::Vector3d& center, const Vector6d& motion) {
  const Eigen::Vector3d turn = motion.head<3>();
  const double angle = turn.norm();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (angle > 0) rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  Pose out = Pose::Identity();
  out.linear() = rotation * world_object.linear();
  out.translation() = rotation * (world_object.translation() - center) + center + motion.tail<3>();
  return out;
}

}  // namespace graspdb::recognition
