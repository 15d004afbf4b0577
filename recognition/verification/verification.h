// How well a posed model explains what the camera saw.
#pragma once

#include <cstdint>
#include <vector>

#include "recognition/models/surface_model.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::recognition {

struct Evidence {
  double scan_explained = 0;  // how well the segment's points lie on the model, 0 to 1
  double model_seen = 0;  // share of the expected visible surface that was measured there, 0 to 1
  double unoccluded = 0;  // share of the facing surface that nothing else hides, 0 to 1
  double rms_m = 0;       // of the explained points, across the surface
  double score = 0;       // both directions together, 0 to 1
  // Shares of the facing surface where the camera saw it, something else, or nothing. The rest is
  // occluded.
  double confirmed = 0;
  double contradicted = 0;
  double unmeasured = 0;
  std::size_t point_count = 0;  // of the segment
};

// Residuals in both directions, coverage and free space: a posed object may not stand where the
// camera looked through. `tolerance_m` is the distance at which surfaces are no longer the same.
// A first look takes some of the segment's points and the coarse surface. `segment` is in the world
// frame.
struct VerificationOptions {
  double tolerance_m = 0.008;
  bool coarse = false;
  // Where the segment's points alone show that the score is lower, the rest is not computed; the
  // score is 0 then.
  double min_score = 0;
  // Of that surface, as the camera sees it from about there (VisibleSurface::mask); it is computed
  // where this is null.
  const std::vector<std::uint8_t>* visible = nullptr;
};
Evidence Verify(const SurfaceModel& model, const Pose& world_object, const SoaCloud& segment,
                const DepthBuffer& depth_buffer, const VerificationOptions& options);

}  // namespace graspdb::recognition
