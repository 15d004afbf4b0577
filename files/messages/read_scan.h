// Reads clouds and depth images that others sent, which are untrusted.
#pragma once

#include <cstddef>
#include <limits>
#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/points/scan.h"

namespace graspdb::files {

// What a scan may be, and how an error names a field of it.
struct ScanRules {
  // INVALID_ARGUMENT for the field at `path`, such as "cloud.data". `description` goes on with a
  // verb: "has 5 bytes".
  absl::Status (*wrong)(std::string_view path, std::string_view description);
  // Or pixels; of a server its --max-points.
  std::size_t max_points = std::numeric_limits<std::size_t>::max();
  int min_stride = 1;         // bytes of a point, up to 4096
  bool allows_blank = false;  // a scan may have no measurement at all
};

// Fills `scan->points` (sensor frame, m), including NaN, and `scan->width`. The errors of
// `rules.wrong` with a field of the cloud at `path` for a wrong stride, size or component, for too
// many points, for no measurement, and for coordinates that can only be millimetres. Takes 12 bytes
// a point. Thread-safe, as the next.
absl::Status ReadScan(const v1::PointCloud& cloud, const ScanRules& rules, std::string_view path,
                      recognition::Scan* scan);

// Fills `scan->depth_image`, where 65535 becomes 0. The same errors; also for wrong intrinsics and
// a wrong unit. Takes 2 bytes a pixel.
absl::Status ReadScan(const v1::DepthImage& image, const ScanRules& rules, std::string_view path,
                      recognition::Scan* scan);

}  // namespace graspdb::files
