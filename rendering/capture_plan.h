// Plans of simulated captures; nothing is rendered here. Thread-safe.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"
#include "recognition/base/types.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// A workpiece on the table.
struct Placement {
  std::size_t part = 0;  // position in the list of workpieces
  recognition::Pose world_object = recognition::Pose::Identity();  // T_world_object
};

// One capture to take.
struct PlannedCapture {
  std::string path;  // of the cloud, relative to the capture set
  v1::Capture::Split split = v1::Capture::SPLIT_UNSPECIFIED;
  std::vector<Placement> placements;  // the first one names the capture
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  std::uint64_t seed = 0;
};

// INVALID_ARGUMENT when the capture has a workpiece that is not in `parts`.
absl::Status CheckPlacements(const std::vector<Workpiece>& parts, const PlannedCapture& capture);

// Pose of the camera, which looks at the origin of the world frame.
struct CameraStand {
  std::vector<double> look_down_deg = {40};
  std::vector<double> distances_m = {0.8};
  double azimuth_deg = -90;
};

// Every workpiece alone at the origin, turned by 0, step, twice the step, … up to a whole turn,
// captured from every look-down angle and distance. The camera does not turn.
struct TurntableOptions {
  CameraStand stand;
  double azimuth_step_deg = 15;
  v1::Capture::Split split = v1::Capture::TEACH;
  std::uint64_t seed = 1;
};

// Workpieces in turn, at random positions within the area and random azimuths, captured from the
// camera's first look-down angle and distance.
struct RandomSceneOptions {
  CameraStand stand;
  int count = 0;
  // The named workpiece has |x| and |y| up to this.
  double area_half_width_m = 0.10;
  // The others of a scene are within the region of interest and apart from each other; they may
  // occlude the named one.
  int objects_per_scene = 1;
  v1::Capture::Split split = v1::Capture::QUERY;
  std::uint64_t seed = 1;
};

// Half the side of the region of interest around the origin.
inline constexpr double kRegionHalfWidthM = 0.30;

// INVALID_ARGUMENT when there is no workpiece, two share their object and stable pose, or an option
// is out of range. The same arguments give the same plan.
absl::StatusOr<std::vector<PlannedCapture>> PlanTurntable(const std::vector<Workpiece>& parts,
                                                          const TurntableOptions& options);

// As PlanTurntable; FAILED_PRECONDITION when a scene has no space for its objects.
absl::StatusOr<std::vector<PlannedCapture>> PlanRandomScenes(const std::vector<Workpiece>& parts,
                                                             const RandomSceneOptions& options);

}  // namespace graspdb::rendering
