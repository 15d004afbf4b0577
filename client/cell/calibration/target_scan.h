// A scan in which a target is, laid on its model.
#pragma once

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"
#include "recognition/segmentation/segmentation.h"
#include "recognition/verification/depth_buffer.h"

namespace graspdb::client {

// How well a model lies where it was refined to.
struct TargetFit {
  recognition::Pose world_target = recognition::Pose::Identity();  // T_world_target
  double seen = 0;    // share of the surface in sight that was measured where it should be, 0 to 1
  double shown = 0;   // share of the surface facing the camera that nothing hides, 0 to 1
  double own = 0;     // voxels that lie on it and face as it does
  double beside = 0;  // voxels that do not, but are near: where the target should end, it goes on

  // For comparison. An object that is held ends in the air but where it is gripped; a wrist or a
  // plate, on which it may be laid as well, goes on.
  double value() const { return own > beside ? seen * seen * (own - beside) : 0; }
};

// Immutable; safe for concurrent reads.
class TargetScan {
 public:
  // `points` (sensor frame, m, no NaN): the target and what is near it; `scan`: the whole frame,
  // for what the camera looked through is free. `world_sensor`: with the table at z = 0 where the
  // target stands `on_table`, else any.
  TargetScan(const recognition::Points& points, const recognition::Points& scan,
             const recognition::Pose& world_sensor, bool on_table);

  // Voxels of `points`, world frame, normals towards the sensor.
  const recognition::OrientedCloud& cloud() const { return cloud_; }

  // Refines `count` guesses in place, quickly and among all points; each within 2 cm.
  void RefineRoughly(const recognition::SurfaceModel& model, TargetFit* guesses,
                     std::size_t count) const;

  // Refines on the points that lie on the model alone, within 1 cm: what holds it is not pulled on.
  TargetFit Refine(const recognition::SurfaceModel& model,
                   const recognition::Pose& world_target) const;

 private:
  // Sets own and beside, of every so many voxels.
  void Count(const recognition::SurfaceModel& model, std::size_t stride, TargetFit* fit) const;
  TargetFit RefineOnce(const recognition::SurfaceModel& model,
                       const recognition::Pose& world_target) const;
  // As the target's own points, of `points`, are seen: all others may hide it.
  recognition::DepthBuffer DepthBufferOf(recognition::Indices own) const;

  recognition::Scan frame_;  // `points`, and then all of the frame
  std::size_t point_count_;  // of `points`
  recognition::Pose world_sensor_;
  bool on_table_;
  recognition::OrientedCloud cloud_;
};

}  // namespace graspdb::client
