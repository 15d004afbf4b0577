// Capture sets from a simulated camera.
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "absl/status/status.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/geometry.pb.h"
#include "rendering/capture_plan.h"
#include "rendering/depth_camera.h"
#include "rendering/scene.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Where the parts of all plans stand, in the world frame.
v1::AxisAlignedBox SimulatedRegion();

// A capture set of these parts in that region, without captures yet.
v1::CaptureSet DeclareParts(const std::vector<Workpiece>& parts);

// How a capture set describes one of the objects in a planned capture, which `parts` has.
v1::Capture CaptureOf(const std::vector<Workpiece>& parts, const PlannedCapture& planned,
                      const Placement& placement);

// What the camera looks at in a planned capture. `parts` outlives it, and has what is placed.
Scene SceneOf(const std::vector<Workpiece>& parts, const PlannedCapture& capture, bool with_table);

// How planned captures are taken.
struct SimulationOptions {
  DepthCameraModel camera = KinectV2();
  bool with_table = true;
  // Only the points of the named workpiece are written, and the captures say so.
  bool segmented = false;
  // A capture set that is there is replaced; else it is an error.
  bool overwrite = false;
};

// Either may be empty.
struct SimulationWatch {
  std::function<void(int done, int total)> report;  // after every capture
  std::function<bool()> cancelled;                  // asked before every capture
};

// Takes the captures of `plan` and writes a capture set to `folder`: organised
// clouds in the sensor frame with the sensor pose in their VIEWPOINT line, the
// meshes in models/, and captures.json with everything that is known. It is
// written last and at once, so that an interrupted run leaves none. The same
// arguments give the same files on one machine.
//
// ALREADY_EXISTS when a set is there and must not be replaced; CANCELLED;
// FAILED_PRECONDITION when nothing of a workpiece is within the camera's sight;
// INVALID_ARGUMENT for a plan that does not fit `parts`; otherwise the errors of
// WriteFileAtomically and RayCaster.
absl::Status WriteSimulation(const std::filesystem::path& folder,
                             const std::vector<Workpiece>& parts,
                             const std::vector<PlannedCapture>& plan,
                             const SimulationOptions& options, const SimulationWatch& watch = {});

}  // namespace graspdb::client
