#include "lab/experiment/shown_segment.h"

#include <algorithm>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::lab {

using recognition::Segment;

absl::StatusOr<ShownSegment> SegmentShown(const Trial& trial,
                                          const recognition::RecognitionParameters& parameters) {
  recognition::StageLog log;
  ASSIGN_OR_RETURN(auto segmentation, recognition::SegmentScan(
                                          trial.scan, parameters.segmentation,
                                          parameters.descriptor, [] { return false; }, &log));
  if (segmentation.segments.empty()) {
    return absl::FailedPreconditionError(absl::StrCat(
        "nothing is seen of it", trial.file.empty() ? "" : " in ", trial.file, "; leave it out"));
  }
  if (!trial.posed && segmentation.segments.size() > 1) {
    return absl::FailedPreconditionError(
        absl::StrCat("it shows ", segmentation.segments.size(),
                     " objects without an object pose; give one to select the object"));
  }
  Segment& nearest = *std::ranges::min_element(segmentation.segments, {}, [&](const Segment& s) {
    return (s.centroid - trial.seen.front()).head<2>().norm();
  });
  return ShownSegment{std::move(nearest), segmentation.world_sensor, segmentation.world_frame};
}

}  // namespace graspdb::lab
