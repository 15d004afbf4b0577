#include "recognition/descriptors/vfh308.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace graspdb::recognition {
namespace {

using Eigen::Vector3f;
constexpr int kShapeBins = 45;
constexpr int kViewpointBins = 128;
// Where the parts begin.
constexpr std::size_t kAlphaStart = kShapeBins;
constexpr std::size_t kPhiStart = 2 * kAlphaStart;
constexpr std::size_t kViewpointStart = 4 * kAlphaStart;

// Angles between the centroid with the mean normal and a point with its normal.
struct PairFeatures {
  float theta;
  float alpha;
  float phi;
};

// False where the features are not defined: the point lies on the centroid or
// in the direction of the normal.
bool ComputePairFeatures(const Vector3f& centroid, const Vector3f& mean_normal, const Vector3f& p,
                         const Vector3f& normal, PairFeatures* out) {
  Vector3f between = p - centroid;
  const float distance = between.norm();
  if (distance == 0) return false;
  Vector3f n1 = mean_normal;
  Vector3f n2 = normal;
  const float angle1 = n1.dot(between) / distance;
  const float angle2 = n2.dot(between) / distance;
  out->phi = angle1;
  if (std::acos(std::fabs(angle1)) > std::acos(std::fabs(angle2))) {
    std::swap(n1, n2);
    between = -between;
    out->phi = -angle2;
  }
  Vector3f v = between.cross(n1);
  const float length = v.norm();
  if (length == 0) return false;
  v /= length;
  const Vector3f w = n1.cross(v);
  out->alpha = v.dot(n2);
  out->theta = std::atan2(w.dot(n2), n1.dot(n2));
  return true;
}

std::size_t ShapeBin(float angle) {
  const double turn = 1.0 / (2.0 * std::numbers::pi);
  const auto raw = static_cast<int>(std::floor(kShapeBins * ((angle + std::numbers::pi) * turn)));
  return static_cast<std::size_t>(std::clamp(raw, 0, kShapeBins - 1));
}

}  // namespace

Descriptor DescribeVfh308(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint) {
  const auto count = static_cast<float>(cloud.points.size());
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d normals = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    sum += cloud.points[i].cast<double>();
    normals += cloud.normals[i].cast<double>();
  }
  const Vector3f centroid = (sum / count).cast<float>();
  const Vector3f mean_normal = (normals / count).cast<float>();
  const Vector3f to_viewpoint = viewpoint.cast<float>() - centroid;
  const Vector3f direction = to_viewpoint / std::sqrt(to_viewpoint.squaredNorm() + 1);

  Descriptor bins(kViewpointStart + kViewpointBins, 0.0F);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    PairFeatures f{};
    if (ComputePairFeatures(centroid, mean_normal, cloud.points[i], cloud.normals[i], &f)) {
      const float step = 100.0F / (count - 1);
      bins[ShapeBin(f.theta)] += step;
      bins[kAlphaStart + ShapeBin(f.alpha)] += step;
      bins[kPhiStart + ShapeBin(f.phi)] += step;
    }
    const double cosine = (cloud.normals[i].dot(direction) + 1.0) * 0.5;
    const auto raw = static_cast<int>(std::floor(cosine * kViewpointBins));
    bins[kViewpointStart + static_cast<std::size_t>(std::clamp(raw, 0, kViewpointBins - 1))] +=
        100.0F / count;
  }
  return bins;
}

}  // namespace graspdb::recognition
