// Conversion of point files to protobuf messages.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"

namespace graspdb::files {

// Points as packed x, y, z floats. `width`: columns of the image, row by row; 0 if not an image.
v1::PointCloud CloudMessage(const recognition::Points& points, int width);

// The points of a cloud from a server (x, y, z floats). INVALID_ARGUMENT for another
// layout.
absl::StatusOr<recognition::Points> PointsFromMessage(const v1::PointCloud& cloud);

// An id computed from the view's points or depth image: the same capture gives the same id.
std::string ContentId(const v1::View& view);

}  // namespace graspdb::files
