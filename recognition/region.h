// The first step: from a scan to the points of the region of interest.
#pragma once

#include <optional>

#include "recognition/types.h"

namespace graspdb::recognition {

// Some points of a scan, moved to another frame.
struct RegionPoints {
  Points points;    // in frame a
  Indices indices;  // where each of them stands in the scan
};

// Whether a scan's point is a measurement: finite, not the origin (sensors report no
// depth as NaN or zero), and not beyond 100 m, where no depth camera sees.
bool IsMeasurement(const Eigen::Vector3f& p);

// Moves the measurements of `scan` (sensor frame, metres) by T_a_sensor and keeps
// those in `region` (frame a); all of them without a region.
RegionPoints CropToRegion(const Points& scan, const Pose& a_sensor,
                          const std::optional<Box>& region);

}  // namespace graspdb::recognition
