// The first step: from a scan to the points of the region of interest.
#pragma once

#include <optional>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/points/scan.h"

namespace graspdb::recognition {

// Some points of a scan, moved to another frame.
struct RegionPoints {
  Points points;    // in frame a
  Indices indices;  // position of each in the scan
  // Measurements that were left out since they are too far from the sensor.
  std::size_t beyond_range_count = 0;
};

// No depth camera measures farther, m.
inline constexpr double kSensorRangeM = 100;

// Whether a scan's point is a measurement: finite, not the origin (sensors report no
// depth as NaN or zero), and not beyond kSensorRangeM.
bool IsMeasurement(const Eigen::Vector3f& p);

// Moves the measurements of `scan` (sensor frame, metres) by T_a_sensor and keeps
// those in `region` (frame a), all of them without a region, that are at most `max_range_m` metres
// from the sensor. O(n). Once cancelled, some of them.
RegionPoints CropToRegion(const Points& scan, const Pose& a_sensor,
                          const std::optional<Box>& region, double max_range_m = kSensorRangeM,
                          const IsCancelled& is_cancelled = {});
// The same of an image, in one pass without making other points. Bit by bit the result of the
// image's points.
RegionPoints CropImage(const DepthImage& image, const Pose& a_sensor,
                       const std::optional<Box>& region, double max_range_m = kSensorRangeM);
// Either, depending on the scan.
RegionPoints CropScan(const Scan& scan, const Pose& a_sensor, const std::optional<Box>& region,
                      double max_range_m = kSensorRangeM, const IsCancelled& is_cancelled = {});

// Whether anything was measured at all.
bool HasMeasurement(const Scan& scan);

// The region of interest of a scan without one, world frame, m: from 5 cm below to 60 cm above the
// table, 0.5 m to each side of the origin, and on to the foot of the sensor at `world_sensor`
// (T_world_sensor), so that objects nearer than the image centre are not cut off.
Box DefaultRegion(const Pose& world_sensor);

}  // namespace graspdb::recognition
