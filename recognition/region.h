// The first step: from a scan to the points of the region of interest.
#pragma once

#include <optional>

#include "recognition/scan.h"
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
// The same of an image, in one pass: no other point is ever made. Bit by bit what comes of the
// image's points.
RegionPoints CropImage(const DepthImage& image, const Pose& a_sensor,
                       const std::optional<Box>& region);
// Either, as the scan has it.
RegionPoints CropScan(const Scan& scan, const Pose& a_sensor, const std::optional<Box>& region);

// Whether anything was measured at all.
bool HasMeasurement(const Scan& scan);

}  // namespace graspdb::recognition
