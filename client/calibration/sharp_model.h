// A model of a target, as exact as its views allow.
#pragma once

#include <memory>
#include <span>

#include "recognition/surface_model.h"

namespace graspdb::client {

// The views fused as the server fuses them, and then every point laid on the plane through all
// points of all views around it that look into its direction: where a cell of the fusion ends, the
// noise of the camera leaves two layers, which a pose that is one of a dozen must not see. Object
// frame, metres. Null without points. Deterministic.
std::shared_ptr<const recognition::SurfaceModel> FuseSharply(
    std::span<const recognition::PosedCloud> views);

}  // namespace graspdb::client
