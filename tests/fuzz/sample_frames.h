// Small scans of the sample parts.
#pragma once

#include <string>

#include "graspdb/v1/catalog_service.pb.h"
#include "tests/server/sample_captures.h"

namespace graspdb::fuzz {

// The middle of a frame, width x height pixels, with matching intrinsics.
testing::Frame Window(const testing::Frame& frame, int width, int height);

// A view of the part alone in the stable pose "flat" of the object of the same name; with its
// object pose or without.
v1::UploadViewsRequest SegmentedView(const std::string& part, double turn_deg,
                                     const std::string& id, bool with_object_pose);

}  // namespace graspdb::fuzz
