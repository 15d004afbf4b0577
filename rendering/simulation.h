// Capture sets from a simulated camera.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/geometry.pb.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/camera/scene.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// Region of the parts of all plans, in the world frame.
v1::AxisAlignedBox SimulatedRegion();

// A capture set of these parts in that region, without captures yet.
v1::CaptureSet DeclareParts(const std::vector<Workpiece>& parts);

// The capture in a capture set for one of the objects of a planned capture; `parts` has the object.
v1::Capture CaptureOf(const std::vector<Workpiece>& parts, const PlannedCapture& planned,
                      const Placement& placement);

// The scene of a planned capture. `parts` outlives it and has all its objects.
Scene SceneOf(const std::vector<Workpiece>& parts, const PlannedCapture& capture, bool with_table);

// Options of a simulation.
struct SimulationOptions {
  DepthCameraModel camera = KinectV2();
  bool with_table = true;
  // Only the points of the named workpiece are written, and the captures are marked as segmented.
  bool segmented = false;
  // Replaces an existing capture set; otherwise an error.
  bool overwrite = false;
};

// Either may be empty.
struct SimulationWatch {
  std::function<void(int done, int total)> report;  // after every capture
  std::function<bool()> cancelled;                  // polled before every capture
};

// Takes the captures of `plan` and writes a capture set to `folder`: organised clouds in the sensor
// frame with the sensor pose in their VIEWPOINT line, the meshes in models/, and captures.json with
// the ground truth. It is written last and atomically, so that an interrupted run leaves none. The
// same arguments give the same files on one machine.
//
// ALREADY_EXISTS when there is a set and `overwrite` is not set; CANCELLED; FAILED_PRECONDITION
// when a workpiece is not visible; INVALID_ARGUMENT for a plan that does not fit `parts`; otherwise
// the errors of WriteFileAtomically and RayCaster.
absl::Status WriteSimulation(const std::filesystem::path& folder,
                             const std::vector<Workpiece>& parts,
                             const std::vector<PlannedCapture>& plan,
                             const SimulationOptions& options, const SimulationWatch& watch = {});

}  // namespace graspdb::rendering
