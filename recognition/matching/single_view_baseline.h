// The paper's pipeline: the view with the nearest descriptor, moved to the scan's centroid and
// aligned.
#pragma once

#include "absl/status/statusor.h"
#include "recognition/matching/matching_parameters.h"
#include "recognition/matching/registration.h"
#include "recognition/models/taught.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::recognition {

// How a view was aligned with a segment.
struct ViewAlignment {
  Pose rough = Pose::Identity();    // T_world_object after the shift
  Pose refined = Pose::Identity();  // T_world_object after the alignment
  Registration registration;
  double score = 0;  // how well view and segment explain each other, 0 to 1
};

// Moves the view's cloud to the segment's centroid (the rough pose), refines it by ICP and judges
// it. Errors as `clouds`.
absl::StatusOr<ViewAlignment> AlignView(const TaughtView& view, const Segment& segment,
                                        ViewClouds& clouds, const MatchingParameters& parameters);

}  // namespace graspdb::recognition
