// What a simulated camera shows, in a file for whoever judges the answers about it.
#pragma once

#include <filesystem>
#include <vector>

#include "client/sensors/simulated_sensor.h"
#include "client/simulation/workpiece.h"

namespace graspdb::client {

// Gives the scenes of `scenes`, and writes each to `path` before it is seen: the JSON of a
// CaptureSet (docs/capture-sets.md) with the declarations of what is shown and a capture for every
// workpiece, whose path is not a file but the name of the scene. Whoever reads it finds it whole.
// The errors of WriteFileAtomically are those of the scene.
SceneSource WithTruthFile(SceneSource scenes, std::vector<Workpiece> parts,
                          std::filesystem::path path);

}  // namespace graspdb::client
