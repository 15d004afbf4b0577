// Orientations of an object relative to a camera, and its visible points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// One side of a model, seen by a camera along z.
struct Side {
  Eigen::Matrix3f look_object = Eigen::Matrix3f::Identity();  // z: the line of sight
  recognition::Points points;    // sampled visible points without duplicates, object frame, m
  recognition::Normals normals;  // object frame
  // Indices of distant points that are aligned with places of a scan.
  std::vector<std::size_t> anchors;
};

// The taught sides of a model, all around and from above, some ten degrees apart; without turns
// about the line of sight. The underside is not taught, because objects stand on a table.
std::vector<Side> SidesOf(const recognition::SurfaceModel& model);

}  // namespace graspdb::client
