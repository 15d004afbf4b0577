// Aligns a target's model with a scan.
#pragma once

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"
#include "recognition/points/nearest_grid.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::client {

// Of a scan: cells of 3 mm, for points up to 21 mm away.
inline recognition::NearestGrid GridOf(const recognition::Points& points) {
  return {points, 0.003F, 0.021F};
}

// Quality of a refined pose.
struct TargetFit {
  recognition::Pose world_target = recognition::Pose::Identity();  // T_world_target
  double seen = 0;    // confirmed share of the visible surface, 0 to 1
  double shown = 0;   // unoccluded share of the surface facing the camera, 0 to 1
  double own = 0;     // voxels on the surface with matching normals
  double beside = 0;  // voxels near the surface but not on it: continues beyond the model

  // For comparison. A gripped object ends in free space except at the gripper; a wrist or a plate
  // that the model may fit as well continues.
  double value() const { return own > beside ? seen * seen * (own - beside) : 0; }
};

// Immutable; safe for concurrent reads.
class TargetScan {
 public:
  // `points` (sensor frame, m, no NaN): the target and its surroundings; `scan`: the whole frame,
  // to detect free space. `world_sensor`: with the table at z = 0 if `on_table`, else any.
  TargetScan(const recognition::Points& points, const recognition::Points& scan,
             const recognition::Pose& world_sensor, bool on_table);

  // Voxels of `points`, world frame, normals towards the sensor.
  const recognition::OrientedCloud& cloud() const { return cloud_; }

  // Coarsely refines `count` guesses in place, on all points; each within 2 cm.
  void RefineRoughly(const recognition::SurfaceModel& model, TargetFit* guesses,
                     std::size_t count) const;

  // Refines only on points on the model, within 1 cm, so that the gripper has no influence.
  TargetFit Refine(const recognition::SurfaceModel& model,
                   const recognition::Pose& world_target) const;

 private:
  // Sets own and beside, from every `stride`-th voxel.
  void Count(const recognition::SurfaceModel& model, std::size_t stride, TargetFit* fit) const;
  TargetFit RefineOnce(const recognition::SurfaceModel& model,
                       const recognition::Pose& world_target) const;
  // With the target's own points, indices into `points`: all others may occlude it.
  recognition::DepthBuffer DepthBufferOf(recognition::Indices own) const;

  recognition::Scan frame_;  // `points`, followed by the whole frame
  std::size_t point_count_;  // of `points`
  recognition::Pose world_sensor_;
  bool on_table_;
  recognition::OrientedCloud cloud_;
};

}  // namespace graspdb::client
