#include "recognition/points/plane.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "recognition/simd/kernels.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

// Enough to draw three inliers once, with the confidence below, when one point in ten is
// on the plane.
constexpr int kMaxIterations = 7000;
constexpr double kConfidence = 0.999;
constexpr std::size_t kScoredPoints = 4000;  // points that hypotheses are scored on
constexpr std::uint64_t kSeed = 20160311;
constexpr int kRefinements = 3;
constexpr double kThinnest = 1e-3;  // sine of the angle in a triangle of three samples

// Every n-th point, so that about kScoredPoints are left; coordinates apart, for SIMD code.
class Sample {
 public:
  explicit Sample(const Points& points) {
    const std::size_t step = std::max<std::size_t>(1, points.size() / kScoredPoints);
    size_ = (points.size() + step - 1) / step;
    // NaN is near no plane.
    const std::size_t padded = simd::Padded(size_);
    for (auto* axis : {&x_, &y_, &z_})
      axis->assign(padded, std::numeric_limits<float>::quiet_NaN());
    for (std::size_t i = 0; i < size_; ++i) {
      const Eigen::Vector3f& p = points[i * step];
      x_[i] = p.x();
      y_[i] = p.y();
      z_[i] = p.z();
    }
  }

  std::size_t size() const { return size_; }
  Vector3d operator[](std::size_t i) const {
    return Eigen::Vector3f(x_[i], y_[i], z_[i]).cast<double>();
  }

  std::size_t CountInliers(const Plane& plane, double distance) const {
    const Eigen::Vector3f normal = plane.normal.cast<float>();
    return simd::Best().count_near_plane({x_.data(), y_.data(), z_.data(), x_.size()},
                                         normal.data(), static_cast<float>(plane.offset),
                                         static_cast<float>(distance));
  }

 private:
  std::size_t size_ = 0;
  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> z_;
};

// The plane through three points, its normal towards the viewpoint.
std::optional<Plane> Through(const Vector3d& a, const Vector3d& b, const Vector3d& c,
                             const Vector3d& viewpoint) {
  Vector3d normal = (b - a).cross(c - a);
  const double length = normal.norm();
  // Three points nearly on a line: the plane would turn with the noise of any of them.
  if (length <= kThinnest * (b - a).norm() * (c - a).norm()) return std::nullopt;
  normal /= length;
  if (normal.dot(viewpoint - a) < 0) normal = -normal;
  return Plane{normal, normal.dot(a)};
}

bool Allowed(const Plane& plane, const PlaneConstraint& constraint) {
  return plane.normal.dot(constraint.axis) >= std::cos(constraint.max_tilt_rad) - 1e-12 &&
         std::abs(plane.offset) <= constraint.max_offset_m;
}

// Samples needed to draw three inliers once with the wanted confidence.
int IterationsNeeded(double inlier_share) {
  const double all_inliers = inlier_share * inlier_share * inlier_share;
  if (all_inliers >= 1) return 1;
  const double needed = std::log(1 - kConfidence) / std::log1p(-all_inliers);
  return static_cast<int>(std::min<double>(kMaxIterations, std::ceil(needed)));
}

// Least squares through the inliers; the plane itself when they span none.
Plane Refine(const Sample& sample, const Plane& plane, double distance, const Vector3d& viewpoint) {
  Vector3d first = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  double count = 0;
  const Vector3d origin = sample[0];  // near the points, so that little is lost in the sums
  for (std::size_t i = 0; i < sample.size(); ++i) {
    const Vector3d p = sample[i];
    if (std::abs(plane.Height(p)) > distance) continue;
    const Vector3d d = p - origin;
    first += d;
    second += d * d.transpose();
    ++count;
  }
  if (count < 3) return plane;
  const Vector3d mean = origin + first / count;
  const Eigen::Matrix3d covariance = second - first * first.transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  Vector3d normal = solver.eigenvectors().col(0);
  if (normal.dot(viewpoint - mean) < 0) normal = -normal;
  return {normal, normal.dot(mean)};
}

}  // namespace

std::optional<Plane> FindPlane(const Points& points, const Vector3d& viewpoint,
                               const PlaneConstraint& constraint) {
  const Sample sample(points);
  if (sample.size() < 3) return std::nullopt;
  std::mt19937_64 random(kSeed);
  const auto draw = [&] { return sample[random() % sample.size()]; };

  std::optional<Plane> best;
  std::size_t best_count = 0;
  int needed = kMaxIterations;
  for (int i = 0; i < needed; ++i) {
    const Vector3d a = draw();
    const Vector3d b = draw();
    const Vector3d c = draw();
    const std::optional<Plane> plane = Through(a, b, c, viewpoint);
    if (!plane || !Allowed(*plane, constraint)) continue;
    const std::size_t count = sample.CountInliers(*plane, constraint.distance_m);
    if (count <= best_count) continue;
    best = plane;
    best_count = count;
    needed = IterationsNeeded(static_cast<double>(count) / static_cast<double>(sample.size()));
  }
  if (!best) return std::nullopt;
  for (int i = 0; i < kRefinements; ++i) {
    const Plane refined = Refine(sample, *best, constraint.distance_m, viewpoint);
    if (!Allowed(refined, constraint)) break;
    best = refined;
  }
  const std::size_t support = sample.CountInliers(*best, constraint.distance_m);
  const double share = static_cast<double>(support) / static_cast<double>(sample.size());
  if (support < 3 || share < constraint.min_share) return std::nullopt;
  return best;
}

std::optional<Pose> WorldFromPlane(const Plane& plane, const Vector3d& viewpoint,
                                   const Vector3d& forward, const Vector3d& right) {
  const double approach = plane.normal.dot(forward);
  if (std::abs(approach) < 1e-6) return std::nullopt;
  const double range = -plane.Height(viewpoint) / approach;
  if (range <= 0) return std::nullopt;
  const Vector3d z = plane.normal;
  const Vector3d in_plane = right - z * z.dot(right);
  if (in_plane.norm() < 1e-6) return std::nullopt;
  const Vector3d x = in_plane.normalized();
  Pose a_world = Pose::Identity();
  a_world.linear() << x, z.cross(x), z;
  a_world.translation() = viewpoint + range * forward;
  return a_world.inverse();
}

}  // namespace graspdb::recognition
