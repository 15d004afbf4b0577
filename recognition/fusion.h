// One surface from what several views have seen of it.
#pragma once

#include <span>

#include "recognition/surface_model.h"

namespace graspdb::recognition {

// Edge of the cells; points of a fused surface are about so far apart, m.
inline constexpr float kFusionCellM = 0.0025F;

// The points of all views within a cell become one, their mean; surfaces that look into
// opposite directions stay apart, and what only one of many views has seen is left out as noise.
// Each mean is then laid on the surface that those around it make: else, where noise carries points
// of one face over the edge of a cell, there are two layers. What has come together by that is one
// point. Object frame, metres. Deterministic.
OrientedCloud Fused(std::span<const PosedCloud> views);

}  // namespace graspdb::recognition
