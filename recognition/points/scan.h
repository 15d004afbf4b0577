// A frame of a sensor.
#pragma once

#include <optional>

#include "recognition/base/types.h"
#include "recognition/points/depth_image.h"

namespace graspdb::recognition {

// Points, or the depth image to make them from.
struct Scan {
  Points points;                     // sensor frame, m; NaN or zero: no measurement
  std::optional<Pose> world_sensor;  // T_world_sensor, where known
  std::optional<Box> region;         // world frame; absent: DefaultRegion
  bool segmented = false;            // the points are one object's and nothing else
  DepthImage depth_image = {};       // in place of `points` where it is not empty
  int width = 0;                     // points in a row of an organised cloud; 0: not organised

  bool is_image() const { return !depth_image.depth.empty(); }
  // Points, measured or not.
  std::size_t size() const { return is_image() ? depth_image.depth.size() : points.size(); }
  // Sensor frame, m; NaN or zero: no measurement.
  Eigen::Vector3f PointAt(std::size_t i) const {
    return is_image() ? recognition::PointAt(depth_image, i) : points[i];
  }
  Eigen::Vector3f PointAt(std::int32_t i) const { return PointAt(static_cast<std::size_t>(i)); }
};

}  // namespace graspdb::recognition
