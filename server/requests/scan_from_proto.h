// Converts clouds and depth images of requests to scans.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/points/scan.h"

namespace graspdb::server {

// Fills `scan->points` (sensor frame, m), including NaN, from a cloud, or `scan->depth_image` from
// a depth image. INVALID_ARGUMENT with the field for no scan or two, for wrong strides, fields,
// sizes, for more than `max_points` points or pixels, for a scan without a measurement, and for one
// whose coordinates can only be millimetres.
absl::Status ReadScan(const v1::RecognizeRequest& request, std::size_t max_points,
                      recognition::Scan* scan);

// The same for the capture of an upload; the fields are within "view".
absl::Status ReadScan(const v1::View& view, std::size_t max_points, recognition::Scan* scan);

}  // namespace graspdb::server
