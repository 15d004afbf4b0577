// Point files as messages of the contract.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "files/point_file.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/geometry.pb.h"

namespace graspdb::client {

// Points as packed x, y, z floats. `width`: columns of the image, row by row; 0 where it is none.
v1::PointCloud CloudMessage(const recognition::Points& points, int width);
v1::PointCloud CloudMessage(const PointFile& file);

// The points of a cloud that a server answered (x, y, z floats). INVALID_ARGUMENT
// for anything else.
absl::StatusOr<recognition::Points> PointsFromMessage(const v1::PointCloud& cloud);

// An id made from the points: the same capture, the same id.
std::string ContentId(const v1::PointCloud& cloud);

}  // namespace graspdb::client
