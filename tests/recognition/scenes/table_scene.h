// Depth images of boxes on a table by ray casting, with the truth for every pixel.
#pragma once

#include <vector>

#include "recognition/base/types.h"

namespace graspdb::testing {

// An object made of boxes along its own axes.
struct Solid {
  recognition::Pose world_solid = recognition::Pose::Identity();
  std::vector<recognition::Box> boxes;
};

// The scene in front of the sensor.
struct Scene {
  std::vector<Solid> solids;
  // Half the edge of the square table at z = 0 about the world's origin; 0: no table.
  double table_half_edge_m = 0.6;
};

inline constexpr int kNothing = -2;
inline constexpr int kTable = -1;

struct Picture {
  recognition::Points points;  // sensor frame, row by row; NaN where nothing is
  std::vector<int> shown;      // kNothing, kTable, or the solid's position in the scene
};

// 160 x 120 pixels, 2.5 mm apart at 0.6 m.
recognition::CameraIntrinsics SmallCamera();

// T_world_sensor of a sensor at `eye` that looks at `target`, its x axis level.
recognition::Pose LookAt(const Eigen::Vector3d& eye, const Eigen::Vector3d& target);

Picture TakePicture(const Scene& scene, const recognition::Pose& world_sensor,
                    const recognition::CameraIntrinsics& camera);

}  // namespace graspdb::testing
