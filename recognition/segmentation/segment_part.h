// Some of the points of a segment as a segment.
#pragma once

#include <functional>

#include "recognition/base/cancellation.h"
#include "recognition/points/scan.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

// Whether a point (world frame, m) belongs to a part.
using IsPartOf = std::function<bool(const Eigen::Vector3f& world)>;

// The voxels and the scan's points of `whole` for which `is_part` is true, in their order; the
// centroid is theirs. O(n) calls for n points. Where cancelled, the result is meaningless.
Segment PartOf(const Scan& scan, const Segmentation& segmentation, const Segment& whole,
               const IsPartOf& is_part, const IsCancelled& is_cancelled = {});

}  // namespace graspdb::recognition
