#include "recognition/scene/image_refinement.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "recognition/scene/image_evidence.h"

namespace graspdb::recognition {
namespace {

using Matrix6 = Eigen::Matrix<float, 6, 6>;
using Vector6 = Eigen::Matrix<float, 6, 1>;

struct Equations {
  Matrix6 left = Matrix6::Zero();
  Vector6 right = Vector6::Zero();
  float weights = 0;
  std::size_t count = 0;
};

// How the distance of `p` along `normal` changes with a step: turns about `center`, in units of
// `radius`, so that all unknowns are metres, then shifts.
Vector6 RowOf(const Eigen::Vector3f& p, const Eigen::Vector3f& normal,
              const Eigen::Vector3f& center, float radius) {
  Vector6 out;
  out << (p - center).cross(normal) / radius, normal;
  return out;
}

Equations Linearised(const Frame& frame, const ImageModel& model, const ModelAspect& aspect,
                     const Eigen::Isometry3f& pose, float reach, std::size_t max_points,
                     float min_cosine) {
  Equations out;
  const std::size_t all = aspect.visible.size();
  const std::size_t wanted = std::min(max_points, all);
  const Eigen::Vector3f center = pose * model.center;
  const float radius = model.diameter_m / 2;
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::size_t i = aspect.visible[k * all / wanted];
    const Eigen::Vector3f p = pose * model.surface.points[i];
    const std::ptrdiff_t at = frame.PixelOf(p);
    if (at < 0) continue;
    const auto pixel = static_cast<std::size_t>(at);
    const float z = frame.depth[pixel];
    if (z == 0 || frame.role[pixel] != PixelRole::kObject) continue;
    const Eigen::Vector3f& seen = frame.normals[pixel];
    if (seen.squaredNorm() == 0) continue;
    const Eigen::Vector3f n = pose.linear() * model.surface.normals[i];
    if (n.dot(seen) < min_cosine) continue;
    const Eigen::Vector3f q = frame.PointAt(pixel, z);
    const Eigen::Vector3f normal = (n + seen).normalized();
    const float residual = normal.dot(q - p);
    const float ratio = residual / reach;
    if (std::abs(ratio) >= 1) continue;
    const float weight = (1 - ratio * ratio) * (1 - ratio * ratio);
    const Vector6 row = RowOf(p, normal, center, radius);
    out.left += weight * row * row.transpose();
    out.right += weight * residual * row;
    out.weights += weight;
    out.count += 1;
  }
  return out;
}

// Of a surface that is measured completely and without noise.
Matrix6 IdealEquations(const ImageModel& model, const ModelAspect& aspect,
                       const Eigen::Isometry3f& pose, std::size_t max_points) {
  Matrix6 out = Matrix6::Zero();
  const std::size_t all = aspect.visible.size();
  const std::size_t wanted = std::min(max_points, all);
  const Eigen::Vector3f center = pose * model.center;
  for (std::size_t k = 0; k < wanted; ++k) {
    const std::size_t i = aspect.visible[k * all / wanted];
    const Eigen::Vector3f n = pose.linear() * model.surface.normals[i];
    const Vector6 row = RowOf(pose * model.surface.points[i], n, center, model.diameter_m / 2);
    out += row * row.transpose();
  }
  return out;
}

// The smallest ratio between what is known and what could be, over the axes of the latter; axes
// along which the object looks the same count little.
float InformationShare(const Matrix6& known, const Matrix6& ideal) {
  const Eigen::SelfAdjointEigenSolver<Matrix6> solver(ideal);
  const float slack = 0.01F * ideal.trace();
  float out = 1;
  for (Eigen::Index axis = 0; axis < 6; ++axis) {
    const Vector6 v = solver.eigenvectors().col(axis);
    out = std::min(out, (v.dot(known * v) + slack) / (v.dot(ideal * v) + slack));
  }
  return out;
}

}  // namespace

Eigen::Isometry3f RefineInImage(const Frame& frame, const PairModel& model,
                                Eigen::Isometry3f sensor_object,
                                const ImageRefinementParameters& parameters) {
  constexpr std::size_t kFewest = 10;
  const float radius = model.diameter_m / 2;
  for (int i = 0; i < parameters.iterations; ++i) {
    const float part = parameters.iterations > 1
                           ? static_cast<float>(i) / static_cast<float>(parameters.iterations - 1)
                           : 1;
    const float reach = parameters.first_reach_m * (1 - part) + parameters.last_reach_m * part;
    const Equations equations =
        Linearised(frame, model, AspectAt(model, sensor_object), sensor_object, reach,
                   parameters.max_points, parameters.min_normal_cosine);
    if (equations.count < kFewest) return sensor_object;
    Matrix6 left = equations.left;
    // Directions that nothing constrains stay as they are.
    left.diagonal().array() += 0.01F * equations.weights;
    const Vector6 step = left.ldlt().solve(equations.right);
    const Eigen::Vector3f turn = step.head<3>() / radius;
    const Eigen::Vector3f center = sensor_object * model.center;
    const float angle = std::min(turn.norm(), 0.3F);
    Eigen::Isometry3f change = Eigen::Isometry3f::Identity();
    if (angle > 1e-7F) {
      change.linear() = Eigen::AngleAxisf(angle, turn.normalized()).toRotationMatrix();
    }
    change.translation() = center - change.linear() * center + step.tail<3>();
    sensor_object = change * sensor_object;
  }
  sensor_object.linear() =
      Eigen::Quaternionf(sensor_object.linear()).normalized().toRotationMatrix();
  return sensor_object;
}

float InformationOf(const Frame& frame, const ImageModel& model, const ModelAspect& aspect,
                    const Eigen::Isometry3f& sensor_object,
                    const ImageRefinementParameters& parameters) {
  const Equations known = Linearised(frame, model, aspect, sensor_object, parameters.last_reach_m,
                                     parameters.max_points, parameters.min_normal_cosine);
  return InformationShare(known.left,
                          IdealEquations(model, aspect, sensor_object, parameters.max_points));
}

}  // namespace graspdb::recognition
