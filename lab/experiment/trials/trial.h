// Frames with known ground truth, rendered on demand.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/recognizer.h"
#include "recognition/segmentation/segmentation.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::lab {

// A frame to teach or to recognize.
struct Trial {
  recognition::Scan scan;
  std::vector<rendering::Placement> truth;  // objects in it; the first is queried
  // Mean of the visible points of each, world frame, m; its position if they are unknown.
  std::vector<Eigen::Vector3d> seen;
  bool posed = true;      // the poses in `truth` are known
  std::string file = {};  // source; empty: none
};

// An obstacle before the lens that hides a share of the first object's pixels, from the side of the
// image to which `direction_rad` points (0: right, pi/2: down).
struct Obstacle {
  double hidden_share = 0;  // 0: none
  double direction_rad = 0;
  // The scan is a segmented cloud: the visible points of the first object alone.
  bool cut_out = false;
};

// Renders planned captures of `parts`, which outlives it. Thread-safe.
class TrialRenderer {
 public:
  static absl::StatusOr<TrialRenderer> Create(const std::vector<rendering::Workpiece>& parts,
                                              const rendering::DepthCameraModel& camera);

  // The region of interest is that of a simulated capture set. Errors as DepthCamera::Render.
  absl::StatusOr<Trial> Render(const rendering::PlannedCapture& capture,
                               const Obstacle& obstacle = {}) const;

 private:
  TrialRenderer(const std::vector<rendering::Workpiece>& parts, rendering::DepthCamera camera)
      : parts_(&parts), camera_(std::move(camera)) {}

  absl::StatusOr<rendering::TriangleMesh> Plate(const rendering::Scene& scene,
                                                const rendering::PlannedCapture& capture,
                                                const Obstacle& obstacle) const;

  const std::vector<rendering::Workpiece>* parts_;
  rendering::DepthCamera camera_;
};

struct ShownSegment {
  recognition::Segment segment;
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  recognition::WorldFrame world_frame = recognition::WorldFrame::kGiven;
};

// The segment of the trial's first object. FAILED_PRECONDITION if it is not visible; errors as
// SegmentScan.
absl::StatusOr<ShownSegment> SegmentShown(const Trial& trial,
                                          const recognition::RecognitionParameters& parameters);

}  // namespace graspdb::lab
