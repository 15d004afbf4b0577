#include "recognition/verification/verification.h"

#include <cmath>
#include <optional>

#include "recognition/simd/rigid_transform.h"
#include "recognition/verification/visibility.h"

namespace graspdb::recognition {
namespace {

// Missing points in a scan of one object alone count less against a pose than free space.
constexpr float kMissingWeight = 0.3F;

}  // namespace

Evidence Verify(const SurfaceModel& model, const Pose& world_object, const SoaCloud& segment,
                const DepthBuffer& depth_buffer, const VerificationOptions& options) {
  Evidence out;
  const auto tolerance = static_cast<float>(options.tolerance_m);
  const auto points = static_cast<double>(segment.point_count());
  if (points == 0 || model.fine.cloud.points.empty()) return out;
  out.point_count = segment.point_count();
  const simd::Support support = simd::Best().support(segment.coordinates().points,
                                                     RigidTransform(world_object.inverse()).rigid(),
                                                     model.look_up(), kSurfaceSpacingM, tolerance);
  out.scan_explained = static_cast<double>(support.explained) / points;
  out.rms_m = support.near > 0 ? static_cast<double>(std::sqrt(support.squares / support.near)) : 0;

  // The score if all of the model were seen.
  if (2 * out.scan_explained < options.min_score * (1 + out.scan_explained)) return out;

  const Eigen::Isometry3f sensor_object = depth_buffer.sensor_world() * world_object.cast<float>();
  const Surface& surface = options.coarse ? model.coarse : model.fine;
  std::optional<VisibleSurface> visible;
  if (options.visible == nullptr) visible.emplace(surface, sensor_object);
  const simd::Seen seen =
      simd::Best().look(surface.columns.coordinates(), RigidTransform(sensor_object).rigid(),
                        (options.visible != nullptr ? *options.visible : visible->mask()).data(),
                        depth_buffer.window(), tolerance, kMissingWeight);
  out.unoccluded = seen.all > 0 ? static_cast<double>(seen.expected / seen.all) : 0;
  if (seen.all > 0) {
    out.confirmed = static_cast<double>(seen.confirmed / seen.all);
    out.contradicted = static_cast<double>(seen.contradicted / seen.all);
    out.unmeasured = static_cast<double>(seen.unmeasured / seen.all);
  }
  out.model_seen = seen.expected > 0 ? static_cast<double>(seen.found / seen.expected) : 0;
  const double sum = out.scan_explained + out.model_seen;
  out.score = sum > 0 ? 2 * out.scan_explained * out.model_seen / sum : 0;
  return out;
}

}  // namespace graspdb::recognition
