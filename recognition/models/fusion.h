// One surface from what several views have seen of it (docs/adr/0018).
#pragma once

#include <memory>
#include <span>

#include "recognition/base/types.h"

namespace graspdb::recognition {

// Edge of the cells; points of a fused surface are about so far apart, m.
inline constexpr float kFusionCellM = 0.0025F;

// One view to fuse.
struct PosedCloud {
  std::shared_ptr<const OrientedCloud> cloud;  // world frame of its capture, m
  Pose world_object = Pose::Identity();        // T_world_object of its capture
};

// The points of all views within a cell become one, their mean; surfaces that look into
// opposite directions stay apart, and what only one of many views has seen is left out as noise.
// Each mean is then laid on the surface that those around it make: else, where noise carries points
// of one face over the edge of a cell, there are two layers. What has come together by that is one
// point. Object frame, metres; empty where nothing is left. Deterministic.
OrientedCloud Fused(std::span<const PosedCloud> views);

}  // namespace graspdb::recognition
