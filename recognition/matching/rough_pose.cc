#include "recognition/matching/rough_pose.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "recognition/descriptors/heading.h"
#include "recognition/verification/visibility.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;

// A step over the table moves objects less in the image of a camera that looks along it: share of
// the step, which is the sine of the angle by which it looks down, 12 degrees. Chosen; not measured
// alone. Doubled, initial poses are not moved away from or towards cameras that look down 12 to 24
// degrees.
constexpr double kMinClimb = 0.2;
// A part up to this multiple of the removed height, 9 of 6 mm by default, may have been removed
// with the table, because of noise. Where the mean of the rest is this far from that of all, m, it
// gives a pose of its own. Chosen; not measured alone. Doubled, parts up to 18 mm count as removed;
// and plates whose rest is 15 to 30 mm off get no such pose, though correspondences reach 20 mm
// only.
constexpr double kRemovedWithTable = 1.5;
constexpr float kStandsElsewhereM = 0.015F;
// Initial poses that are nearer, m, lead to the same place: correspondences reach 0.02 m. Chosen
// (ADR 24); not measured alone. Doubled, a view has fewer initial poses, which are farther from the
// place that they stand for.
constexpr double kSameStartM = 0.006;

class ExtentSum {
 public:
  void Add(const Eigen::Vector3f& p) {
    sum_.mean += p;
    sum_.low = sum_.low.cwiseMin(p);
    sum_.high = sum_.high.cwiseMax(p);
    ++count_;
  }

  // None without points.
  std::optional<Extent> Take() const {
    if (count_ == 0) return std::nullopt;
    Extent out = sum_;
    out.mean /= static_cast<float>(count_);
    return out;
  }

 private:
  Extent sum_ = {.low = Eigen::Vector3f::Constant(1e9F), .high = Eigen::Vector3f::Constant(-1e9F)};
  std::size_t count_ = 0;
};

double Azimuth(const Pose& world_sensor, const Vector3d& point) {
  const Vector3d side = SideSeen(world_sensor, point);
  return std::atan2(side.y(), side.x());
}

Pose TurnedAsSeen(const TaughtView& view, const SurfaceModel& model, const SeenSegment& segment) {
  const Vector3d taught_center = view.world_object * model.center.cast<double>();
  const double turn =
      Azimuth(segment.world_sensor, segment.centroid) - Azimuth(view.world_sensor, taught_center);
  Pose out = Pose::Identity();
  out.linear() =
      Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix() * view.world_object.linear();
  out.translation() = segment.centroid - out.linear() * model.center.cast<double>();
  if (segment.on_table) out.translation().z() = view.world_object.translation().z();
  return out;
}

// The shift over the table that moves a model of visible extent `model` onto the segment.
Vector3d ShiftOnTable(const Extent& model, const Extent& segment, const DepthBuffer::Sides& hidden,
                      const Pose& world_sensor) {
  Eigen::Vector3f image = segment.mean - model.mean;
  const Eigen::Vector3f lows = segment.low - model.low;
  const Eigen::Vector3f highs = segment.high - model.high;
  if (hidden.left != hidden.right) image.x() = hidden.left ? highs.x() : lows.x();
  if (hidden.top != hidden.bottom) image.y() = hidden.top ? highs.y() : lows.y();
  Vector3d right = world_sensor.linear().col(0);
  right.z() = 0;
  right.normalize();
  const Vector3d ahead = Vector3d::UnitZ().cross(right);  // over the table, away from the sensor
  const double climb = -ahead.dot(world_sensor.linear().col(1));  // in the image, by a step ahead
  const double step = std::abs(climb) > kMinClimb ? -static_cast<double>(image.y()) / climb : 0;
  return static_cast<double>(image.x()) * right + step * ahead;
}

// Sides that may be hidden: `hidden`, or where that is every side, as around a segmented scan, any
// one or two neighbouring ones. Doing the same where two opposite sides may be hidden finds one
// more of 648 objects in full frames, and names one more piece of clutter in 15 real ones.
std::vector<DepthBuffer::Sides> SidesToTry(const DepthBuffer::Sides& hidden) {
  const DepthBuffer::Sides every = {.left = true, .right = true, .top = true, .bottom = true};
  if (hidden != every) return {hidden};
  return {{.left = true},
          {.right = true},
          {.top = true},
          {.bottom = true},
          {.left = true, .top = true},
          {.left = true, .bottom = true},
          {.right = true, .top = true},
          {.right = true, .bottom = true}};
}

// Of the visible points at least `lowest` m above the table, with the object at
// `world_object`; nullopt without any.
std::optional<Extent> VisibleExtent(const VisibleSurface& visible, const Points& points,
                                    const Pose& world_object, double lowest) {
  const Eigen::RowVector3f up = world_object.linear().row(2).cast<float>();
  const auto min_height = static_cast<float>(lowest - world_object.translation().z());
  ExtentSum sum;
  for (const std::size_t i : visible.points()) {
    if (up.dot(points[i]) >= min_height) sum.Add(visible.At(i));
  }
  return sum.Take();
}

}  // namespace

double TurnOf(const TaughtView& view, const SeenSegment& segment) {
  const Eigen::Matrix3d& taught = view.world_object.linear();
  return Azimuth(segment.world_sensor, segment.centroid) -
         Azimuth(view.world_sensor, view.world_object.translation()) +
         std::atan2(taught(1, 0), taught(0, 0));
}

Extent ExtentOf(const Points& points, const Eigen::Isometry3f& sensor_points) {
  ExtentSum sum;
  for (const Eigen::Vector3f& point : points) sum.Add(sensor_points * point);
  return sum.Take().value_or(Extent());
}

InitialPoses RoughPoses(const TaughtView& view, const SurfaceModel& model,
                        const SeenSegment& segment, const DepthBuffer::Sides& hidden) {
  const Pose turned = TurnedAsSeen(view, model, segment);
  const Eigen::Isometry3f sensor_object = (segment.world_sensor.inverse() * turned).cast<float>();
  const VisibleSurface visible(model.coarse, sensor_object);
  InitialPoses out = {.poses = {turned}, .visible = visible.mask()};
  const auto extent_above = [&](double lowest) {
    return VisibleExtent(visible, model.coarse.cloud.points, turned, lowest);
  };
  const std::optional<Extent> whole = extent_above(-std::numeric_limits<double>::infinity());
  if (!whole) return out;
  const auto shifted = [&](const Extent& extent, const DepthBuffer::Sides& sides) {
    Pose at = turned;
    at.translation() += ShiftOnTable(extent, segment.extent, sides, segment.world_sensor);
    return at;
  };
  out.poses = {shifted(*whole, {})};
  const auto add = [&](const Pose& pose) {
    const bool is_known = std::ranges::any_of(out.poses, [&](const Pose& other) {
      return (other.translation() - pose.translation()).norm() < kSameStartM;
    });
    if (!is_known) out.poses.push_back(pose);
  };
  for (const DepthBuffer::Sides& sides : SidesToTry(hidden)) add(shifted(*whole, sides));
  if (segment.table_reach_m <= 0) return out;
  // Without parts that may have been removed with the table.
  const std::optional<Extent> above_table = extent_above(kRemovedWithTable * segment.table_reach_m);
  if (above_table && (above_table->mean - whole->mean).norm() > kStandsElsewhereM) {
    add(shifted(*above_table, {}));
  }
  return out;
}

}  // namespace graspdb::recognition
