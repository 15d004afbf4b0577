#include "client/teaching/mesh/top_grasps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "rendering/workpiece.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// An axis is preferred to a later one of the same size, whatever the rounding.
constexpr double kEqualAxes = 1 + 1e-3;
// Of the box around the mesh: a triangle crosses at most as many rows as that.
constexpr double kMaxLines = 1000;
// Of the spacing, from the corner of the box to the first line: no fraction of a symmetric part.
constexpr double kFirstLine = 0.381966;

Eigen::Index MainAxisOf(const Vector3d& normal) {
  const Vector3d size = normal.cwiseAbs();
  Eigen::Index axis = 0;
  for (const Eigen::Index other : {1, 2}) {
    if (size[other] > size[axis] * kEqualAxes) axis = other;
  }
  return axis;
}

class Grid {
 public:
  Grid(const recognition::Box& box, double spacing)
      : first_(box.min - Vector3d::Constant(kFirstLine * spacing)), spacing_(spacing) {}

  double spacing() const { return spacing_; }
  double Line(Eigen::Index axis, int i) const { return first_[axis] + i * spacing_; }
  // The first line at `x` or beyond.
  int From(Eigen::Index axis, double x) const {
    return static_cast<int>(std::ceil((x - first_[axis]) / spacing_));
  }

 private:
  Vector3d first_;
  double spacing_;
};

// Where the side from `a` to `b` crosses the row `v`, lower end included and upper end not, so that
// triangles that share a side share no point; false if it does not.
bool Crosses(Vector3d a, Vector3d b, Eigen::Index u_axis, Eigen::Index v_axis, double v,
             double* u) {
  if (a[v_axis] > b[v_axis]) std::swap(a, b);
  if (v < a[v_axis] || v >= b[v_axis]) return false;
  const double share = (v - a[v_axis]) / (b[v_axis] - a[v_axis]);
  *u = a[u_axis] + share * (b[u_axis] - a[u_axis]);
  return true;
}

void AppendTriangle(const std::array<Vector3d, 3>& corners, const Grid& grid,
                    std::size_t max_points, EvenSamples& out) {
  const Vector3d across = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
  if (!(across.norm() > 0)) return;
  const Vector3d normal = across.normalized();
  const Eigen::Index axis = MainAxisOf(normal);
  const Eigen::Index u_axis = (axis + 1) % 3;
  const Eigen::Index v_axis = (axis + 2) % 3;
  const auto [low, high] =
      std::minmax({corners[0][v_axis], corners[1][v_axis], corners[2][v_axis]});
  for (int row = grid.From(v_axis, low); grid.Line(v_axis, row) < high; ++row) {
    const double v = grid.Line(v_axis, row);
    std::array<double, 3> crossings{};
    std::size_t count = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      double u = 0;
      if (Crosses(corners[k], corners[(k + 1) % 3], u_axis, v_axis, v, &u)) crossings[count++] = u;
    }
    if (count != 2) continue;
    const auto [first, last] = std::minmax({crossings[0], crossings[1]});
    for (int column = grid.From(u_axis, first); grid.Line(u_axis, column) < last; ++column) {
      if (out.areas.size() >= max_points) return;
      Vector3d p = corners[0];
      p[u_axis] = grid.Line(u_axis, column);
      p[v_axis] = v;
      p[axis] -= normal.dot(p - corners[0]) / normal[axis];
      out.cloud.points.push_back(p.cast<float>());
      out.cloud.normals.push_back(normal.cast<float>());
      out.areas.push_back(grid.spacing() * grid.spacing() / std::abs(normal[axis]));
    }
  }
}

constexpr int kSamples = 12'000;
constexpr int kClosingDirections = 24;  // over half a turn
constexpr double kMinPlayM = 0.003;     // on each side of the object when the gripper comes down
constexpr double kPlayM = 0.010;        // on each side, if it can open that far
constexpr double kTouchDepthM = 0.0015;
constexpr float kMinCosine = 0.9397F;  // of 20 degrees
// Share of the object's maximum distance from its centre of mass: beyond it, the object would turn
// in the grasp.
constexpr double kMaxLever = 0.5;
constexpr double kMinTouchM2 = 8e-6;
// Share of the pads that counts as full contact, since few samples lie on them.
constexpr double kFullContact = 0.85;
// Values that differ by less are equal; of equal grasps the first one is proposed, so that rounding
// does not decide.
constexpr double kEqualValue = 1e-3;
constexpr double kOtherGraspRad = 45 * std::numbers::pi / 180;

struct Candidate {
  double closing_rad = 0;
  Vector3d tcp = Vector3d::Zero();
  double width_m = 0;
  double value = 0;
};

// The first of those that are as good as the best one; null without one.
const Candidate* FirstOfBest(const std::vector<const Candidate*>& candidates) {
  if (candidates.empty()) return nullptr;
  const auto value = [](const Candidate* one) { return one->value; };
  const double best = (*std::ranges::max_element(candidates, {}, value))->value;
  return *std::ranges::find_if(
      candidates, [&](const Candidate* one) { return one->value >= best - kEqualValue; });
}

const Candidate* FirstOfBest(const std::vector<Candidate>& candidates) {
  std::vector<const Candidate*> all;
  all.reserve(candidates.size());
  for (const Candidate& one : candidates) all.push_back(&one);
  return FirstOfBest(all);
}

// The object turned so that the fingers close along x.
class Turned {
 public:
  Turned(const EvenSamples& samples, const Vector3d& mass, double closing_rad,
         const ParallelGripper& gripper)
      : areas_(samples.areas), closing_rad_(closing_rad), gripper_(gripper) {
    const recognition::OrientedCloud& surface = samples.cloud;
    const Eigen::AngleAxisd turn(-closing_rad, Vector3d::UnitZ());
    const Eigen::Matrix3f forth = turn.toRotationMatrix().cast<float>();
    mass_ = turn * mass;
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
      points_.push_back(forth * surface.points[i]);
      cosines_.push_back((forth * surface.normals[i]).x());
      top_ = std::max(top_, static_cast<double>(points_.back().z()));
      const Eigen::Vector2d arm = points_.back().cast<double>().head<2>() - mass_.head<2>();
      reach_ = std::max(reach_, arm.norm());
    }
  }

  std::optional<Candidate> Best() const {
    std::vector<Candidate> fitting;
    const double deep = std::max(kOffTableM, mass_.z() - gripper_.pad_height_m / 2);
    const double highest = top_ - gripper_.finger_length_m;
    const double step = gripper_.finger_width_m / 4;
    const int steps = static_cast<int>(std::ceil(reach_ / step));
    for (const double tips : {kOffTableM, deep, top_ - gripper_.pad_height_m}) {
      if (tips < std::max(kOffTableM, highest)) continue;
      for (int k = -steps; k <= steps; ++k) {
        if (const auto found = At(mass_.y() + k * step, tips)) fitting.push_back(*found);
      }
    }
    const Candidate* best = FirstOfBest(fitting);
    return best == nullptr ? std::nullopt : std::optional(*best);
  }

 private:
  struct Span {
    float low = 0;
    float high = 0;
    bool is_empty = true;
  };

  bool IsSwept(const Vector3f& p, double y, double tips) const {
    return std::abs(static_cast<double>(p.y()) - y) <= gripper_.finger_width_m / 2 &&
           static_cast<double>(p.z()) >= tips;
  }

  Span SpanOf(double y, double tips) const {
    Span out;
    for (const Vector3f& p : points_) {
      if (!IsSwept(p, y, tips)) continue;
      out.low = out.is_empty ? p.x() : std::min(out.low, p.x());
      out.high = out.is_empty ? p.x() : std::max(out.high, p.x());
      out.is_empty = false;
    }
    return out;
  }

  // With the middle of the fingers at y and their tips at height `tips`.
  std::optional<Candidate> At(double y, double tips) const {
    const Span span = SpanOf(y, tips);
    const auto width = static_cast<double>(span.high - span.low);
    if (span.is_empty || width + 2 * kMinPlayM > gripper_.max_opening_m) return std::nullopt;
    double low = 0;
    double high = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Vector3f& p = points_[i];
      if (!IsSwept(p, y, tips) || static_cast<double>(p.z()) > tips + gripper_.pad_height_m) {
        continue;
      }
      const bool is_low = p.x() < span.low + static_cast<float>(kTouchDepthM);
      const bool is_high = p.x() > span.high - static_cast<float>(kTouchDepthM);
      if (is_low && cosines_[i] < -kMinCosine) low += areas_[i];
      if (is_high && cosines_[i] > kMinCosine) high += areas_[i];
    }
    const double touching = std::min(low, high);
    if (touching < kMinTouchM2) return std::nullopt;
    const double x = static_cast<double>(span.low + span.high) / 2;
    const double lever = std::hypot(y - mass_.y(), x - mass_.x());
    if (lever > kMaxLever * reach_) return std::nullopt;
    const double pad = gripper_.finger_width_m * gripper_.pad_height_m;
    const double value = std::min(1.0, touching / (kFullContact * pad)) -
                         2 * lever / gripper_.max_opening_m - 0.5 * width / gripper_.max_opening_m;
    const Eigen::AngleAxisd back(closing_rad_, Vector3d::UnitZ());
    return Candidate{closing_rad_, back * Vector3d(x, y, tips + gripper_.pad_height_m / 2), width,
                     value};
  }

  const std::vector<double>& areas_;
  double closing_rad_;
  const ParallelGripper& gripper_;
  Vector3d mass_;
  std::vector<Vector3f> points_;
  std::vector<float> cosines_;  // of the normals to x
  double top_ = 0;
  double reach_ = 0;  // across the table, from the centre of mass
};

v1::Grasp GraspOf(const Candidate& found, const char* id, int priority,
                  const ParallelGripper& gripper) {
  const double opening = std::min(found.width_m + 2 * kPlayM, gripper.max_opening_m);
  v1::Grasp grasp = rendering::TopGrasp(id, found.tcp, found.closing_rad, opening);
  grasp.set_priority(priority);
  grasp.set_retreat_distance_m(grasp.approach_distance_m());
  return grasp;
}

// Between two closing directions, which are the same after half a turn.
double AngleBetween(double a, double b) {
  const double apart = std::abs(std::remainder(a - b, std::numbers::pi));
  return std::min(apart, std::numbers::pi - apart);
}

}  // namespace

EvenSamples SampleEvenly(const rendering::TriangleMesh& mesh, int count) {
  EvenSamples out;
  const std::size_t max_points = 2 * static_cast<std::size_t>(std::max(count, 0));
  const double area = rendering::AreaOf(mesh);
  if (!(area > 0)) return out;
  const recognition::Box box = rendering::BoundsOf(mesh);
  const Grid grid(box,
                  std::max(std::sqrt(area / count), (box.max - box.min).maxCoeff() / kMaxLines));
  for (const std::array<int, 3>& t : mesh.triangles) {
    std::array<Vector3d, 3> corners;
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = mesh.vertices[static_cast<std::size_t>(t[k])].cast<double>();
    }
    AppendTriangle(corners, grid, max_points, out);
  }
  return out;
}

std::vector<v1::Grasp> ProposeTopGrasps(const GraspedObject& object,
                                        const ParallelGripper& gripper) {
  const EvenSamples samples = SampleEvenly(*object.mesh, kSamples);
  std::vector<Candidate> found;
  for (int k = 0; k < (object.any_turn ? 1 : kClosingDirections); ++k) {
    const Turned turned(samples, object.mass_center, std::numbers::pi * k / kClosingDirections,
                        gripper);
    if (const auto best = turned.Best()) found.push_back(*best);
  }
  std::vector<v1::Grasp> out;
  const Candidate* best = FirstOfBest(found);
  if (best == nullptr) return out;
  out.push_back(GraspOf(*best, "top", 1, gripper));
  if (object.any_turn) return out;
  std::vector<const Candidate*> others;
  for (const Candidate& one : found) {
    if (AngleBetween(one.closing_rad, best->closing_rad) >= kOtherGraspRad - 1e-9) {
      others.push_back(&one);
    }
  }
  const Candidate* other = FirstOfBest(others);
  if (other != nullptr) out.push_back(GraspOf(*other, "top-2", 0, gripper));
  return out;
}

}  // namespace graspdb::client
