// Points of an unoccluded surface that a camera sees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recognition/models/surface_model.h"

namespace graspdb::recognition {

// Points of one surface that face the sensor and are not hidden by the surface itself, by a depth
// buffer whose cells are 2.5 times the points' spacing. O(n) in the points.
class VisibleSurface {
 public:
  // `sensor_object`: T_sensor_object, where `surface` is in the object frame.
  VisibleSurface(const Surface& surface, const Eigen::Isometry3f& sensor_object);

  // Positions in the surface of the visible points, ascending.
  const std::vector<std::size_t>& points() const { return visible_; }
  // A visible or hidden point in the sensor frame, m.
  Eigen::Vector3f At(std::size_t i) const { return {x_[i], y_[i], z_[i]}; }
  // Of each point of the surface, with its padding: 1 where it is visible.
  const std::vector<std::uint8_t>& mask() const { return mask_; }

 private:
  // Removes points that others of the surface hide.
  void Hide(float spacing_m);

  std::vector<float> x_;
  std::vector<float> y_;
  std::vector<float> z_;
  std::vector<std::uint8_t> mask_;
  std::vector<std::size_t> visible_;
};

}  // namespace graspdb::recognition
