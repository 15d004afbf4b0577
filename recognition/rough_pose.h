// Where a stable pose may stand, before anything is aligned.
#pragma once

#include <vector>

#include "recognition/segmentation.h"
#include "recognition/sight.h"
#include "recognition/surface_model.h"
#include "recognition/taught.h"

namespace graspdb::recognition {

// Mean and extent of what the camera sees, sensor frame, m.
struct Extent {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f low = Eigen::Vector3f::Zero();
  Eigen::Vector3f high = Eigen::Vector3f::Zero();
};
Extent ExtentOf(const Points& points, const Eigen::Isometry3f& sensor_points);

// T_world_object of the stable pose of `view`, seen from the side that the view shows: turned as
// the line of sight has turned since it was taught, what the camera sees of `model` with its
// mean on that of the segment (`seen`). Where sides of the segment are `hidden`, a second one, with
// the edges on each other that are not.
std::vector<Pose> RoughPoses(const TaughtView& view, const SurfaceModel& model,
                             const Pose& world_sensor, const Eigen::Vector3d& segment_centroid,
                             const Extent& seen, const Eigen::Isometry3f& sensor_world,
                             const Sight::Sides& hidden);

}  // namespace graspdb::recognition
