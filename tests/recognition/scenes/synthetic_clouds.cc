#include "tests/recognition/scenes/synthetic_clouds.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace graspdb::testing {

using Eigen::Vector3d;
using recognition::OrientedCloud;
using recognition::Points;
using recognition::Pose;

double Uniform(Random& random, double lo, double hi) {
  return std::uniform_real_distribution<double>(lo, hi)(random);
}

Vector3d RandomDirection(Random& random) {
  const double z = Uniform(random, -1, 1);
  const double turn = Uniform(random, 0, 2 * std::numbers::pi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(turn), r * std::sin(turn), z};
}

Pose RandomPose(Random& random, double max_shift_m) {
  const Vector3d axis = RandomDirection(random);
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(Uniform(random, 0, std::numbers::pi), axis).toRotationMatrix();
  for (double& x : pose.translation()) x = Uniform(random, -max_shift_m, max_shift_m);
  return pose;
}

Pose RandomMotion(Random& random, const Vector3d& center, double angle_rad, double shift_m) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_rad, RandomDirection(random)).toRotationMatrix();
  pose.translation() = center - pose.linear() * center + shift_m * RandomDirection(random);
  return pose;
}

Points RandomPoints(Random& random, std::size_t count, double size_m) {
  Points out(count);
  for (auto& p : out) {
    for (float& x : p) x = static_cast<float>(Uniform(random, -size_m / 2, size_m / 2));
  }
  return out;
}

OrientedCloud WavySurface(Random& random, std::size_t count) {
  OrientedCloud out;
  for (std::size_t i = 0; i < count; ++i) {
    const double x = Uniform(random, -0.06, 0.06);
    const double y = Uniform(random, -0.04, 0.05);
    const double z = 0.010 * std::sin(45 * x + 1) + 0.008 * std::cos(60 * y) + 2 * x * y + 0.2 * x;
    const double slope_x = 0.45 * std::cos(45 * x + 1) + 2 * y + 0.2;
    const double slope_y = -0.48 * std::sin(60 * y) + 2 * x;
    out.points.emplace_back(Vector3d(x, y, z).cast<float>());
    out.normals.emplace_back(Vector3d(-slope_x, -slope_y, 1).normalized().cast<float>());
  }
  return out;
}

OrientedCloud Moved(const Pose& pose, const OrientedCloud& cloud) {
  OrientedCloud out;
  for (const auto& p : cloud.points) {
    out.points.emplace_back((pose * p.cast<double>()).cast<float>());
  }
  for (const auto& n : cloud.normals) {
    out.normals.emplace_back((pose.linear() * n.cast<double>()).cast<float>());
  }
  return out;
}

OrientedCloud Reordered(Random& random, OrientedCloud cloud) {
  std::vector<std::size_t> order(cloud.points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::shuffle(order.begin(), order.end(), random);
  OrientedCloud out;
  for (const std::size_t i : order) {
    out.points.push_back(cloud.points[i]);
    out.normals.push_back(cloud.normals[i]);
  }
  return out;
}

OrientedCloud MirroredInX(OrientedCloud cloud) {
  for (auto& p : cloud.points) p.x() = -p.x();
  for (auto& n : cloud.normals) n.x() = -n.x();
  return cloud;
}

}  // namespace graspdb::testing
