// Views of a mesh as a cell's camera would take them.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "client/teaching/upload/view_upload.h"
#include "graspdb/v1/cell.pb.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// T_world_sensor of the cell's camera with the origin moved to the point on the table at which it
// looks: where its axis meets the table z = 0, or the middle of the cell's region of interest if
// the axis misses the region. The angle, distance and roll are those of the cell.
//
// FAILED_PRECONDITION when the cell has no sensor pose, or neither a camera that looks down at the
// table nor a region of interest; INVALID_ARGUMENT as CheckPose.
absl::StatusOr<recognition::Pose> StandOf(const v1::Cell& cell);

// How the views are taken. The camera stands still, and each object turns about its z axis.
struct CadViews {
  rendering::DepthCameraModel camera = rendering::KinectV2();
  recognition::Pose world_sensor = recognition::Pose::Identity();  // the object is at the origin
  double step_deg = 20;                                            // as the paper's turntable
  // Also teach stable poses that already have other views.
  bool beside_others = false;
};

// Renders a turn of every workpiece and teaches it; objects and stable poses are created as needed,
// existing ones keep their grasps, and get the mesh's frame if they have none (not with
// `beside_others`: their views may be in a frame of their own). The view at an azimuth does not
// depend on the step, so repeating a call changes nothing, or continues an interrupted call.
//
// FAILED_PRECONDITION when a workpiece is not in the camera's view, or (without `beside_others`)
// when a stable pose has views that are not of this mesh, camera and place, or the frame of another
// mesh; INVALID_ARGUMENT for a step that is not between 1 and 120 degrees; errors of TeachViews and
// DepthCamera.
absl::StatusOr<UploadCounts> TeachCadViews(Client& client,
                                           const std::vector<rendering::Workpiece>& parts,
                                           const CadViews& views, const UploadWatch& watch);

// The number of these views; 0 for an invalid step.
std::size_t CountOf(const std::vector<rendering::Workpiece>& parts, const CadViews& views);

}  // namespace graspdb::client
