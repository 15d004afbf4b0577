// Converts clouds and depth images of requests to scans.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/points/scan.h"

namespace graspdb::server {

// Fills `scan->points` (sensor frame, m), including NaN. INVALID_ARGUMENT for wrong
// strides, fields, sizes, for more than `max_points` points, for a cloud without a
// measurement, and for one whose coordinates can only be millimetres.
absl::Status ReadCloud(const v1::PointCloud& cloud, std::size_t max_points, std::string_view path,
                       recognition::Scan* scan);

// The same for `scan->depth_image`.
absl::Status ReadDepthImage(const v1::DepthImage& image, std::size_t max_points,
                            std::string_view path, recognition::Scan* scan);

// A cloud of packed x, y, z floats, as in the server's responses.
v1::PointCloud PointsToProto(const recognition::Points& points);

}  // namespace graspdb::server
