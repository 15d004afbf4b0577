// Frames of real cameras with meshes rendered into them: ground truth without end.
#pragma once

#include <cstdint>

#include "absl/status/statusor.h"
#include "lab/experiment/trials/frames_file.h"
#include "lab/experiment/trials/part_set.h"
#include "recognition/points/scan.h"
#include "recognition/recognizer.h"

namespace graspdb::lab {

struct CompositeOptions {
  int objects = 3;  // to place; fewer where there is no space
  std::uint64_t seed = 1;
};

// A scan, and what stands there. The objects that the background shows have no pose in `frame`: new
// ones may hide them, so that they count as neither found nor wrong.
struct Composite {
  RealFrame frame;
  recognition::Scan scan;  // an organised cloud
};

// Places parts of `set` on the table of `background`, within the region, and renders them with the
// errors of one of the simulated cameras. Half of them are next to what stands there, and a quarter
// lean. The background hides parts behind it; at least 40 % of a part is in view. Deterministic.
// FAILED_PRECONDITION without a table; errors as DepthCamera.
absl::StatusOr<Composite> Compose(const RealFrame& background, const recognition::Scan& scan,
                                  const PartSet& set,
                                  const recognition::RecognitionParameters& parameters,
                                  const CompositeOptions& options);

}  // namespace graspdb::lab
