// Clouds and depth images of requests become points.
#pragma once

#include <string_view>

#include "absl/status/statusor.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/types.h"

namespace graspdb::server {

// The points of a cloud (sensor frame, m), NaN kept. INVALID_ARGUMENT for wrong
// strides, fields, sizes, for more than `max_points` points, for a cloud without
// one measurement, and for one whose coordinates can only be millimetres.
absl::StatusOr<recognition::Points> PointsFromProto(const v1::PointCloud& cloud,
                                                    std::size_t max_points, std::string_view path);

// The same for a depth image.
absl::StatusOr<recognition::Points> PointsFromProto(const v1::DepthImage& image,
                                                    std::size_t max_points, std::string_view path);

// A cloud of packed x, y, z floats, as the server answers it.
v1::PointCloud PointsToProto(const recognition::Points& points);

}  // namespace graspdb::server
