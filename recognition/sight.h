// What the camera saw along each line of sight around a segment.
#pragma once

#include <vector>

#include "recognition/segmentation.h"
#include "recognition/types.h"

namespace graspdb::recognition {

// A coarse depth image around one segment, made from the points of the scan, organised or not.
// Immutable; safe for concurrent reads.
class Sight {
 public:
  // `scan` is in the sensor frame of `segment`'s capture. Where the scan holds nothing but the
  // segment, a pixel without a point was free, or the sensor failed there, or whoever cut the thing
  // out has lost it.
  Sight(const Scan& scan, const Pose& world_sensor, const Segment& segment);

  // What is known of a place where a surface is claimed to be.
  enum class Finding {
    kThere,    // a surface was measured there
    kHidden,   // something else stands before it
    kDenied,   // the camera looked through it, or saw the segment's surface before it
    kMissing,  // nothing was measured, in a scan that shows the thing alone
    kUnknown,  // nothing was measured
  };
  struct Look {
    Finding finding = Finding::kUnknown;
    float distance_m = 0;  // kThere: between claimed and measured surface, across the surface
  };

  // `point` and its unit `normal` in the sensor frame; surfaces nearer than `tolerance_m` are
  // the same.
  Look At(const Eigen::Vector3f& point, const Eigen::Vector3f& normal, float tolerance_m) const;

  // Sides of the image on which something nearer cuts the segment off.
  struct Sides {
    bool left = false;
    bool right = false;
    bool top = false;
    bool bottom = false;
    bool operator==(const Sides&) const = default;
  };
  Sides HiddenSides() const { return SidesWhere(/*unmeasured_too=*/false); }
  // Those, and sides beyond which nothing was measured: it may be something too near for the
  // sensor.
  Sides UnseenSides() const { return SidesWhere(/*unmeasured_too=*/true); }

  const Eigen::Isometry3f& sensor_world() const { return sensor_world_; }

 private:
  struct Pixel {
    float depth_m = 0;  // of the nearest point; 0: none
    bool of_segment = false;
  };
  const Pixel* PixelAt(int x, int y) const;
  const Pixel* PixelAt(const Eigen::Vector2i& at) const { return PixelAt(at.x(), at.y()); }
  Eigen::Vector2i Project(const Eigen::Vector3f& point) const;
  // Whether the segment's pixel `at` ends, a `step` on, because something else hides what follows.
  bool IsCut(const Eigen::Vector2i& at, const Eigen::Vector2i& step, bool unmeasured_too) const;
  Sides SidesWhere(bool unmeasured_too) const;

  Eigen::Isometry3f sensor_world_;
  bool segmented_;
  Eigen::Vector2f low_ = Eigen::Vector2f::Zero();  // of the window, x/z and y/z
  Eigen::Vector2i size_ = Eigen::Vector2i::Zero();
  std::vector<Pixel> pixels_;
};

}  // namespace graspdb::recognition
