// The points of a segmented scan, without its voxels.
#pragma once

#include <optional>

#include "recognition/base/cancellation.h"
#include "recognition/base/types.h"
#include "recognition/points/scan.h"
#include "recognition/segmentation/segmentation_parameters.h"

namespace graspdb::recognition {

// The points (Segment::indices) of the segment that SegmentScan finds in a segmented scan if it is
// not too large and no points are left out as too far from the others. For callers that need
// nothing else of the segment: voxels take most of SegmentScan's time. Absent in all other cases,
// in rare ones that only the voxels decide, and once cancelled. O(n).
std::optional<Indices> SegmentedPoints(const Scan& scan, const SegmentationParameters& parameters,
                                       double voxel_size_m, const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
