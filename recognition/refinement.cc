#include "recognition/refinement.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "recognition/motion.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3f;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// Standard deviation of a voxel's place across the surface, m; what the priors are held against.
constexpr double kPointDeviationM = 0.0012;
// Points of a scan err together: so many count as one against a prior.
constexpr double kPointsThatErrTogether = 30;
// Surfaces that face each other less than this do not correspond.
constexpr float kMinAgreement = 0.5F;
// Neighbours on one surface are about so far apart, m.
constexpr float kSpacingM = 0.003F;
// Weight of the distance along a surface that has ended, against that across it.
constexpr double kEdgeWeight = 0.3;
constexpr float kMinFacing = 0.2F;
// The scan's points are about so far apart, m.
constexpr double kVoxelM = 0.003;
constexpr double kNegligibleMoveM = 2e-5;
// A measured table says more than a calibration: its deviations are so much smaller.
constexpr double kMeasuredTableShare = 0.25;

// The normal equations of one step: a turn about `center` and then a move, world frame.
class Step {
 public:
  explicit Step(const Vector3f& center) : center_(center) {}

  // The point `q` shall move by `residual` along the unit vector `direction`.
  void Add(const Vector3f& q, const Vector3f& direction, double residual, double weight) {
    Vector6d row;
    row << (q - center_).cross(direction).cast<double>(), direction.cast<double>();
    hessian_.noalias() += weight * row * row.transpose();
    gradient_ += weight * residual * row;
    total_ += weight;
  }

  void AddPrior(int parameter, double value, double deviation) {
    const double ratio = kPointDeviationM / deviation;
    const double weight = ratio * ratio * std::max(1.0, total_ / kPointsThatErrTogether);
    hessian_(parameter, parameter) += weight;
    gradient_(parameter) += weight * value;
  }

  bool is_empty() const { return total_ <= 0; }

  Vector6d Solve() const {
    Matrix6d damped = hessian_;
    damped.diagonal().array() += 1e-9 * std::max(1.0, total_);
    return damped.ldlt().solve(gradient_);
  }

 private:
  Vector3f center_;
  Matrix6d hessian_ = Matrix6d::Zero();
  Vector6d gradient_ = Vector6d::Zero();
  double total_ = 0;
};

double Tukey(float distance, float reach) {
  const float share = distance / reach;
  if (share >= 1) return 0;
  const float rest = 1 - share * share;
  return static_cast<double>(rest * rest);
}

// Pulls the model point `q` to `p`: across the surface, and along it where that has ended.
void Pull(const Vector3f& p, const Vector3f& q, const Vector3f& normal, bool across, float reach,
          double share, Step* step) {
  const Vector3f d = p - q;
  const double weight = share * Tukey(d.norm(), reach);
  if (weight <= 0) return;
  const float height = d.dot(normal);
  if (across) step->Add(q, normal, static_cast<double>(height), weight);
  const Vector3f along = d - height * normal;
  const float beyond = along.norm() - kSpacingM;
  if (beyond <= 0) return;
  step->Add(q, along.normalized(), static_cast<double>(beyond), kEdgeWeight * weight);
}

void AddScan(const SurfaceModel& model, const RefinementTarget& target, const Pose& world_object,
             float reach, int stride, Step* step) {
  const Motion forth(world_object);
  const Motion back(world_object.inverse());
  for (std::size_t i = 0; i < target.cloud.points.size(); i += static_cast<std::size_t>(stride)) {
    const Vector3f& p = target.cloud.points[i];
    const int nearest = model.grid.Nearest(back.Point(p));
    if (nearest < 0) continue;
    const auto at = static_cast<std::size_t>(nearest);
    const Vector3f normal = forth.Direction(model.fine.cloud.normals[at]);
    if (normal.dot(target.cloud.normals[i]) < kMinAgreement) continue;
    Pull(p, forth.Point(model.fine.cloud.points[at]), normal, true, reach, 1, step);
  }
}

// The model's edges that the camera would see and that reach beyond the scan.
void AddEdges(const Surface& surface, const RefinementTarget& target, const Pose& world_object,
              float reach, double weight, Step* step) {
  const Motion forth(world_object);
  const Motion sensor_world(target.sight.sensor_world());
  const Vector3f viewpoint = target.sight.sensor_world().inverse().translation();
  for (std::size_t i = 0; i < surface.cloud.points.size(); ++i) {
    const Vector3f q = forth.Point(surface.cloud.points[i]);
    const Vector3f normal = forth.Direction(surface.cloud.normals[i]);
    const Vector3f sight = viewpoint - q;
    if (normal.dot(sight) < kMinFacing * sight.norm()) continue;
    const int nearest = target.grid.Nearest(q);
    if (nearest < 0) continue;
    const auto at = static_cast<std::size_t>(nearest);
    if (normal.dot(target.cloud.normals[at]) < kMinAgreement) continue;
    if ((target.cloud.points[at] - q).squaredNorm() < kSpacingM * kSpacingM) continue;
    const Sight::Look look =
        target.sight.At(sensor_world.Point(q), sensor_world.Direction(normal), kSpacingM);
    if (look.finding != Sight::Finding::kDenied && look.finding != Sight::Finding::kMissing) {
      continue;
    }
    Pull(target.cloud.points[at], q, normal, false, reach, weight, step);
  }
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

Pose Moved(const Pose& world_object, const Vector3f& center, const Vector6d& step) {
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  if (angle > 0) rotation = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
  Pose out = Pose::Identity();
  const Eigen::Vector3d c = center.cast<double>();
  out.linear() = rotation * world_object.linear();
  out.translation() = rotation * (world_object.translation() - c) + c + step.tail<3>();
  return out;
}

}  // namespace

Refinement Refine(const SurfaceModel& model, const RefinementTarget& target, const Pose& initial,
                  const RefinementOptions& options, const IsKnown& is_known) {
  Refinement out{initial};
  Pose& pose = out.world_object;
  const double shrink =
      options.iterations > 1
          ? std::pow(options.last_reach_m / options.first_reach_m, 1.0 / (options.iterations - 1))
          : 1;
  const Surface& surface = options.coarse ? model.coarse : model.fine;
  // Points of the model count for as much area as those of the scan.
  const double density = static_cast<double>(surface.spacing_m) / kVoxelM;
  const double edge_share = density * density / options.stride;
  double reach = options.first_reach_m;
  for (; out.iterations < options.iterations; ++out.iterations, reach *= shrink) {
    const Vector3f center = (pose * model.center.cast<double>()).cast<float>();
    Step step(center);
    AddScan(model, target, pose, static_cast<float>(reach), options.stride, &step);
    AddEdges(surface, target, pose, static_cast<float>(reach), edge_share, &step);
    if (step.is_empty()) return out;
    if (target.on_table) AddTable(model, target.table, pose, center, options, &step);
    const Vector6d move = step.Solve();
    pose = Moved(pose, center, move);
    const double moved =
        move.tail<3>().norm() + move.head<3>().norm() * static_cast<double>(model.radius_m);
    if (moved < kNegligibleMoveM && reach <= 1.01 * options.last_reach_m) break;
    if (is_known && out.iterations + 1 < options.iterations && is_known(pose)) {
      out.stopped = true;
      return out;
    }
  }
  return out;
}

}  // namespace graspdb::recognition
