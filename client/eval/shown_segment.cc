#include "client/eval/shown_segment.h"

#include <algorithm>

#include "absl/status/status.h"

namespace graspdb::client {

using recognition::Segment;

absl::StatusOr<ShownSegment> SegmentShown(const Trial& trial,
                                          const recognition::RecognitionParameters& parameters) {
  recognition::StageLog log;
  auto segmentation = recognition::SegmentScan(
      trial.scan, parameters.segmentation, parameters.descriptor, [] { return false; }, &log);
  if (!segmentation.ok()) return segmentation.status();
  if (segmentation->segments.empty()) {
    return absl::FailedPreconditionError("nothing is seen of it; leave it out");
  }
  Segment& nearest = *std::ranges::min_element(segmentation->segments, {}, [&](const Segment& s) {
    return (s.centroid - trial.seen.front()).norm();
  });
  return ShownSegment{std::move(nearest), segmentation->world_sensor};
}

}  // namespace graspdb::client
