// Scenes for a simulated camera.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "recognition/base/types.h"
#include "rendering/meshes/mesh.h"

namespace graspdb::rendering {

// A mesh at a pose.
struct PlacedMesh {
  const TriangleMesh* mesh = nullptr;                              // outlives the scene
  recognition::Pose world_object = recognition::Pose::Identity();  // T_world_object
};

// Objects, and a square table whose top is at z = 0 around the origin.
struct Scene {
  std::vector<PlacedMesh> objects;
  bool with_table = true;
  double table_half_width_m = 1.0;
};

// Surface of a pixel: the position of an object in Scene::objects, or one of these.
inline constexpr std::int32_t kTableSurface = -1;
inline constexpr std::int32_t kNoSurface = -2;
inline constexpr std::int32_t kFlyingPixel = -3;  // a mixture of two surfaces

}  // namespace graspdb::rendering
