#include "lab/experiment/trials/trial.h"

#include <algorithm>
#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/pose_message.h"
#include "rendering/simulation.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// Position of the obstacle, as a share of the camera's distance from the origin: outside of the
// region of interest.
constexpr double kPlateNearness = 0.4;

// A large plate across the view at `depth_m` (sensor frame), that covers all directions
// x/z, y/z whose component along `direction` is larger than `edge`. Both sides.
rendering::TriangleMesh PlateMesh(const Vector2d& direction, double edge, double depth_m) {
  const Vector2d along(-direction.y(), direction.x());
  rendering::TriangleMesh out;
  for (const auto& [a, b] :
       {std::pair(edge, -2.0), {edge + 2, -2.0}, {edge + 2, 2.0}, {edge, 2.0}}) {
    const Vector2d at = (a * direction + b * along) * depth_m;
    out.vertices.push_back(Vector3d(at.x(), at.y(), depth_m).cast<float>());
  }
  out.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 2, 1}, {0, 3, 2}};
  return out;
}

Vector3d MeanSeen(const rendering::DepthFrame& frame, int object, const Trial& trial) {
  Vector3d sum = Vector3d::Zero();
  int count = 0;
  for (std::size_t i = 0; i < frame.surface.size(); ++i) {
    const Vector3f& p = trial.scan.points[i];
    if (frame.surface[i] != object || !p.allFinite() || p.z() <= 0) continue;
    sum += *trial.scan.world_sensor * p.cast<double>();
    ++count;
  }
  if (count == 0) return trial.truth[static_cast<std::size_t>(object)].world_object.translation();
  return sum / count;
}

// Keeps the points of the first object alone.
void CutOut(const rendering::DepthFrame& frame, recognition::Scan* scan) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < frame.surface.size(); ++i) {
    if (frame.surface[i] == 0) scan->points[kept++] = scan->points[i];
  }
  scan->points.resize(kept);
  scan->width = 0;
  scan->region.reset();
  scan->segmented = true;
}

}  // namespace

absl::StatusOr<TrialRenderer> TrialRenderer::Create(const std::vector<rendering::Workpiece>& parts,
                                                    const rendering::DepthCameraModel& camera) {
  ASSIGN_OR_RETURN(rendering::DepthCamera made, rendering::DepthCamera::Create(camera));
  return TrialRenderer(parts, std::move(made));
}

absl::StatusOr<rendering::TriangleMesh> TrialRenderer::Plate(
    const rendering::Scene& scene, const rendering::PlannedCapture& capture,
    const Obstacle& obstacle) const {
  ASSIGN_OR_RETURN(rendering::DepthFrame clear,
                   camera_.Render(scene, capture.world_sensor, capture.seed));
  const recognition::CameraIntrinsics& k = camera_.model().intrinsics;
  const Vector2d direction(std::cos(obstacle.direction_rad), std::sin(obstacle.direction_rad));
  std::vector<double> along;  // of the object's pixels
  for (std::size_t i = 0; i < clear.surface.size(); ++i) {
    if (clear.surface[i] != 0) continue;
    const std::size_t row = i / static_cast<std::size_t>(clear.width);
    const std::size_t column = i % static_cast<std::size_t>(clear.width);
    along.push_back(direction.dot(Vector2d((static_cast<double>(column) - k.cx) / k.fx,
                                           (static_cast<double>(row) - k.cy) / k.fy)));
  }
  if (along.empty()) return absl::FailedPreconditionError("the object is not visible");
  const auto rank = static_cast<std::ptrdiff_t>(static_cast<double>(along.size() - 1) *
                                                (1 - obstacle.hidden_share));
  std::nth_element(along.begin(), along.begin() + rank, along.end());
  const double distance = capture.world_sensor.translation().norm();
  const double depth = kPlateNearness * distance;
  // The projector's shadow of the plate also hides the object, to the right of the plate.
  const double shadow = camera_.model().effects.shadow_baseline_m * (1 / depth - 1 / distance);
  const double shadowed = shadow * std::max(0.0, -direction.x());
  return PlateMesh(direction, along[static_cast<std::size_t>(rank)] + shadowed, depth);
}

absl::StatusOr<Trial> TrialRenderer::Render(const rendering::PlannedCapture& capture,
                                            const Obstacle& obstacle) const {
  rendering::Scene scene;
  for (const rendering::Placement& p : capture.placements) {
    scene.objects.push_back({.mesh = &(*parts_)[p.part].mesh, .world_object = p.world_object});
  }
  rendering::TriangleMesh plate;
  if (obstacle.hidden_share > 0) {
    ASSIGN_OR_RETURN(plate, Plate(scene, capture, obstacle));
    scene.objects.push_back({.mesh = &plate, .world_object = capture.world_sensor});
  }
  ASSIGN_OR_RETURN(rendering::DepthFrame frame,
                   camera_.Render(scene, capture.world_sensor, capture.seed));
  Trial out{.scan = {.points = rendering::ToPoints(frame, camera_.model().intrinsics),
                     .world_sensor = capture.world_sensor,
                     .region = files::FromMessage(rendering::SimulatedRegion()),
                     .segmented = false,
                     .width = camera_.model().intrinsics.width},
            .truth = capture.placements,
            .seen = {}};
  for (std::size_t i = 0; i < out.truth.size(); ++i) {
    out.seen.push_back(MeanSeen(frame, static_cast<int>(i), out));
  }
  if (obstacle.cut_out) CutOut(frame, &out.scan);
  return out;
}

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
  recognition::Segment& nearest =
      *std::ranges::min_element(segmentation.segments, {}, [&](const recognition::Segment& s) {
        return (s.centroid - trial.seen.front()).head<2>().norm();
      });
  return ShownSegment{std::move(nearest), segmentation.world_sensor, segmentation.world_frame};
}

}  // namespace graspdb::lab
