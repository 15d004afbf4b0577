// Fusion of several views into one surface (docs/adr/0018).
#pragma once

#include <memory>
#include <span>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// Edge of the cells and approximate spacing of a fused surface, m.
inline constexpr float kFusionCellM = 0.0025F;

// One view to fuse.
struct PosedCloud {
  std::shared_ptr<const OrientedCloud> cloud;  // world frame of its capture, m
  Pose world_object = Pose::Identity();        // T_world_object of its capture
};

// The points of all views within a cell become one, their mean; surfaces that look into opposite
// directions stay apart, and points that only one of many views has seen are left out as noise.
// Each mean is then projected onto the surface of its neighbours: otherwise noise that moves points
// of one face over the edge of a cell makes two layers. Points that coincide after that are merged.
// Object frame, metres; empty where nothing is left. Deterministic.
OrientedCloud Fused(std::span<const PosedCloud> views);

}  // namespace graspdb::recognition
