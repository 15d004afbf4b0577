// Orientations of an object relative to a camera, and its visible points.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"

namespace graspdb::client {

// One side of a model, as a camera sees it that looks along z.
struct Side {
  Eigen::Matrix3f look_object = Eigen::Matrix3f::Identity();  // z: the line of sight
  recognition::Points points;    // some of what is seen, each once, object frame, m
  recognition::Normals normals;  // object frame
  // Points, far from each other, that are laid on a scan to try this side there.
  std::vector<std::size_t> anchors;
};

// The sides from which a model was taught, all around and from above, some ten degrees apart; not
// turned about the line of sight. What stands on a table shows nothing from below.
std::vector<Side> SidesOf(const recognition::SurfaceModel& model);

}  // namespace graspdb::client
