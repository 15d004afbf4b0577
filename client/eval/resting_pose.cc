#include "client/eval/resting_pose.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

namespace graspdb::client {
namespace {

using Eigen::Vector3d;

constexpr int kDirections = 3000;
constexpr int kNeighbors = 8;
constexpr double kSameAttitudeRad = 10 * std::numbers::pi / 180;

// Evenly spread over the sphere (Fibonacci's lattice).
std::vector<Vector3d> Directions() {
  std::vector<Vector3d> out;
  out.reserve(kDirections);
  const double golden = std::numbers::pi * (3 - std::sqrt(5.0));
  for (int i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kDirections;
    const double r = std::sqrt(1 - z * z);
    out.emplace_back(r * std::cos(golden * i), r * std::sin(golden * i), z);
  }
  return out;
}

// Height of the centre of mass over the table when `down` points down.
class Height {
 public:
  Height(const TriangleMesh& mesh, const Vector3d& center) {
    arms_.reserve(mesh.vertices.size());
    for (const auto& v : mesh.vertices) arms_.push_back((v.cast<double>() - center).cast<float>());
  }

  double operator()(const Vector3d& down) const {
    const Eigen::Vector3f d = down.cast<float>();
    float height = -std::numeric_limits<float>::infinity();
    for (const Eigen::Vector3f& arm : arms_) height = std::max(height, arm.dot(d));
    return static_cast<double>(height);
  }

 private:
  std::vector<Eigen::Vector3f> arms_;
};

// The lowest direction near `down`: around it, in rings that become smaller.
Vector3d Descend(const Height& height, Vector3d down) {
  double lowest = height(down);
  for (double radius = 0.04; radius > 2e-4;) {
    const Vector3d x = down.unitOrthogonal();
    const Vector3d y = down.cross(x);
    bool moved = false;
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * std::numbers::pi * k / 12;
      const Vector3d next =
          (down + radius * (std::cos(angle) * x + std::sin(angle) * y)).normalized();
      const double there = height(next);
      if (there < lowest - 1e-7) {
        lowest = there;
        down = next;
        moved = true;
        break;
      }
    }
    if (!moved) radius /= 2;
  }
  return down;
}

// For each direction the one among its neighbours and itself that is lowest.
std::vector<int> LowestNeighbors(const std::vector<Vector3d>& directions,
                                 const std::vector<double>& heights) {
  std::vector<int> lowest(directions.size());
  std::vector<std::pair<double, int>> near(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) {
    for (std::size_t j = 0; j < directions.size(); ++j) {
      near[j] = {-directions[i].dot(directions[j]), static_cast<int>(j)};
    }
    std::partial_sort(near.begin(), near.begin() + kNeighbors + 1, near.end());
    lowest[i] = std::min_element(near.begin(), near.begin() + kNeighbors + 1,
                                 [&](const auto& a, const auto& b) {
                                   return heights[static_cast<std::size_t>(a.second)] <
                                          heights[static_cast<std::size_t>(b.second)];
                                 })
                    ->second;
  }
  return lowest;
}

recognition::Pose PoseWithDown(const TriangleMesh& mesh, const Vector3d& down) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.linear() = Eigen::Quaterniond::FromTwoVectors(down, -Vector3d::UnitZ()).toRotationMatrix();
  const recognition::Box box = BoundsOf(Transformed(mesh, pose));
  const Vector3d middle = (box.min + box.max) / 2;
  pose.translation() = Vector3d(-middle.x(), -middle.y(), -box.min.z());
  return pose;
}

}  // namespace

absl::StatusOr<std::vector<RestingPose>> RestingPoses(const TriangleMesh& mesh,
                                                      double min_probability) {
  if (absl::Status checked = CheckMesh(mesh); !checked.ok()) return checked;
  const absl::StatusOr<Vector3d> center = CenterOfMass(mesh);
  if (!center.ok()) return center.status();
  const Height height(mesh, *center);
  const std::vector<Vector3d> directions = Directions();
  std::vector<double> heights;
  heights.reserve(directions.size());
  for (const Vector3d& d : directions) heights.push_back(height(d));
  const std::vector<int> lower = LowestNeighbors(directions, heights);

  std::map<int, int> basins;  // where directions end, and how many
  for (int i = 0; i < kDirections; ++i) {
    int at = i;
    while (lower[static_cast<std::size_t>(at)] != at) at = lower[static_cast<std::size_t>(at)];
    ++basins[at];
  }
  std::vector<std::pair<Vector3d, int>> attitudes;  // down, directions
  for (const auto& [at, count] : basins) {
    const Vector3d down = Descend(height, directions[static_cast<std::size_t>(at)]);
    const auto same = std::find_if(attitudes.begin(), attitudes.end(), [&](const auto& other) {
      return other.first.dot(down) > std::cos(kSameAttitudeRad);
    });
    if (same == attitudes.end()) {
      attitudes.emplace_back(down, count);
    } else {
      same->second += count;
    }
  }
  std::stable_sort(attitudes.begin(), attitudes.end(),
                   [](const auto& a, const auto& b) { return a.second > b.second; });
  std::vector<RestingPose> out;
  for (const auto& [down, count] : attitudes) {
    const double probability = static_cast<double>(count) / kDirections;
    if (probability < min_probability) break;
    out.push_back({PoseWithDown(mesh, down), probability});
  }
  return out;
}

}  // namespace graspdb::client
