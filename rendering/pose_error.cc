#include "rendering/pose_error.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace graspdb::rendering {
namespace {

using recognition::Pose;

// Poses are compared at this many points of the surface ...
constexpr int kMeasuredPoints = 1000;
// ... with this many others: on a 10 cm part these are less than 0.5 mm apart, which is the
// smallest measurable error.
constexpr int kSearchedPoints = 50'000;
// Turned shapes that differ less than this share of the diameter are equal.
constexpr double kSameShape = 0.02;
constexpr int kComparedTurns = 72;

struct Distances {
  double mean_m = 0;
  double largest_m = 0;
};

// From the shape moved by `found_truth` to the shape.
Distances DistancesOf(const MeasuredShape& shape, const Pose& found_truth) {
  Distances out;
  const Eigen::Isometry3f moved = found_truth.cast<float>();
  for (const auto& p : shape.points) {
    const double d =
        std::sqrt(static_cast<double>(shape.search.Nearest(moved * p).squared_distance));
    out.mean_m += d;
    out.largest_m = std::max(out.largest_m, d);
  }
  out.mean_m /= static_cast<double>(shape.points.size());
  return out;
}

Pose TurnAboutZ(double rad) { return Pose(Eigen::AngleAxisd(rad, Eigen::Vector3d::UnitZ())); }

double AngleOf(const Eigen::Matrix3d& rotation) {
  return std::abs(Eigen::AngleAxisd(rotation).angle());
}

// `difference` is T_found_truth.
double RotationModulo(const Eigen::Matrix3d& difference, const std::vector<double>& turns_rad,
                      bool any_turn) {
  // Only the direction of the axis counts.
  if (any_turn) return std::acos(std::clamp(difference(2, 2), -1.0, 1.0));
  double best = std::numbers::pi;
  for (const double turn : turns_rad) {
    best = std::min(best, AngleOf(difference * TurnAboutZ(turn).linear()));
  }
  return best;
}

double StrictlyRightM(const MeasuredShape& shape) {
  return std::max(0.008, 0.06 * shape.diameter_m);
}

void FindTurns(MeasuredShape* shape) {
  shape->is_round = true;
  shape->turns_rad.clear();
  for (int k = 0; k < kComparedTurns; ++k) {
    const double turn = 2 * std::numbers::pi * k / kComparedTurns;
    const Distances d = DistancesOf(*shape, TurnAboutZ(turn));
    shape->is_round = shape->is_round && d.largest_m <= StrictlyRightM(*shape);
    if (k == 0 || d.largest_m < kSameShape * shape->diameter_m) shape->turns_rad.push_back(turn);
  }
  shape->any_turn = shape->turns_rad.size() == kComparedTurns;
}

}  // namespace

MeasuredShape Measure(const TriangleMesh& mesh) {
  return {.points = SampleSurface(mesh, kMeasuredPoints, /*seed=*/1),
          .search = recognition::PointSearch(SampleSurface(mesh, kSearchedPoints, /*seed=*/2)),
          .diameter_m = DiameterOf(mesh)};
}

MeasuredShape Measure(const Workpiece& part) {
  MeasuredShape out = Measure(part.mesh);
  FindTurns(&out);
  return out;
}

std::vector<double> TurnsOf(int symmetry_order) {
  const int turns = std::max(1, symmetry_order);
  std::vector<double> out;
  out.reserve(static_cast<std::size_t>(turns));
  for (int k = 0; k < turns; ++k) out.push_back(2 * std::numbers::pi * k / turns);
  return out;
}

MeasuredShape Measure(const recognition::SurfaceModel& model, int symmetry_order) {
  const recognition::Points& surface = model.fine.cloud.points;
  MeasuredShape out{.points = {},
                    .search = recognition::PointSearch(surface),
                    .turns_rad = TurnsOf(symmetry_order),
                    .any_turn = symmetry_order == 0,
                    .is_round = symmetry_order == 0};
  const std::size_t stride = surface.size() / kMeasuredPoints + 1;
  out.points.reserve(surface.size() / stride + 1);
  for (std::size_t i = 0; i < surface.size(); i += stride) {
    for (const Eigen::Vector3f& other : out.points) {
      out.diameter_m = std::max(out.diameter_m, static_cast<double>((surface[i] - other).norm()));
    }
    out.points.push_back(surface[i]);
  }
  return out;
}

PoseError ErrorOf(const MeasuredShape& shape, const Pose& truth, const Pose& found) {
  const Pose difference = found.inverse() * truth;
  const Distances there = DistancesOf(shape, difference);
  const Distances back = DistancesOf(shape, difference.inverse());
  return {.add_s_m = there.mean_m,
          .hausdorff_m = std::max(there.largest_m, back.largest_m),
          .rotation_rad = RotationModulo(difference.linear(), shape.turns_rad, shape.any_turn),
          .translation_m = (truth.translation() - found.translation()).norm()};
}

double AddS(const MeasuredShape& shape, const Pose& truth, const Pose& found) {
  return DistancesOf(shape, found.inverse() * truth).mean_m;
}

double RotationError(const Pose& truth, const Pose& found, int symmetry_order) {
  return RotationModulo((found.inverse() * truth).linear(), TurnsOf(symmetry_order),
                        symmetry_order == 0);
}

bool IsRight(const MeasuredShape& shape, double add_s_m) {
  return add_s_m < 0.05 * shape.diameter_m;
}

bool IsStrictlyRight(const MeasuredShape& shape, const PoseError& error) {
  return error.hausdorff_m <= StrictlyRightM(shape);
}

}  // namespace graspdb::rendering
