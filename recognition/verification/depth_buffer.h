// Depths along the lines of sight around a segment.
#pragma once

#include <vector>

#include "recognition/base/types.h"
#include "recognition/simd/surface_kernels.h"
#include "recognition/verification/scan_depths.h"

namespace graspdb::recognition {

// A coarse depth image around one segment, made from the points of the scan, organised or not.
// Immutable; safe for concurrent reads.
class DepthBuffer {
 public:
  // The scan is in the sensor frame of `segment`'s capture. Where the scan contains only the
  // segment, a pixel without a point was free, or the sensor failed there, or it was lost when the
  // object was cut out.
  DepthBuffer(const ScanDepths& depths, const Pose& world_sensor, const Segment& segment);
  DepthBuffer(const Scan& scan, const Pose& world_sensor, const Segment& segment)
      : DepthBuffer(ScanDepths(scan), world_sensor, segment) {}

  // Sides of the image on which something nearer cuts the segment off.
  struct Sides {
    bool left = false;
    bool right = false;
    bool top = false;
    bool bottom = false;
    bool operator==(const Sides&) const = default;
  };
  Sides HiddenSides() const { return SidesWhere(/*unmeasured_too=*/false); }
  // Those, and sides beyond which nothing was measured: an object too near for the sensor may be
  // there.
  Sides UnseenSides() const { return SidesWhere(/*unmeasured_too=*/true); }

  // For SIMD code, while this lives.
  simd::DepthWindow window() const;

  const Eigen::Isometry3f& sensor_world() const { return sensor_world_; }

 private:
  static constexpr int kBorder = 3;

  // Position of a pixel's depth; up to kBorder beyond the window it stays 0.
  std::size_t PlaceOf(const Eigen::Vector2i& at) const {
    return static_cast<std::size_t>(at.y() + kBorder) * row_ +
           static_cast<std::size_t>(at.x() + kBorder);
  }
  float DepthAt(const Eigen::Vector2i& at) const { return depths_[PlaceOf(at)]; }
  // Whether something else hides the segment a `step` beyond its pixel `at`.
  bool IsCut(const Eigen::Vector2i& at, const Eigen::Vector2i& step, bool unmeasured_too) const;
  Sides SidesWhere(bool unmeasured_too) const;

  Eigen::Isometry3f sensor_world_;
  bool alone_;
  PixelWindow window_;
  std::size_t row_ = 0;  // places between the beginnings of rows
  // Of the nearest point, m: the segment's as they are, of anything else negative; 0: none.
  std::vector<float> depths_;
};

}  // namespace graspdb::recognition
