// What simulated cameras show, in a file for whoever judges the answers about it.
#pragma once

#include <filesystem>
#include <vector>

#include "absl/status/status.h"
#include "client/sensors/simulated_sensor.h"
#include "client/simulation/workpiece.h"

namespace graspdb::client {

// Writes the JSON of a CaptureSet (docs/capture-sets.md) with the declarations of what is shown and
// a capture for every workpiece of every scene, whose path is not a file but the name of the scene.
// Whoever reads it finds it whole. Placements that `parts` has not are passed over. The errors of
// WriteFileAtomically.
absl::Status WriteTruth(const std::filesystem::path& path, const std::vector<Workpiece>& parts,
                        const std::vector<PlannedCapture>& scenes);

// Gives the scenes of `scenes`, and writes each to `path` before it is seen. The errors of
// WriteTruth are those of the scene.
SceneSource WithTruthFile(SceneSource scenes, std::vector<Workpiece> parts,
                          std::filesystem::path path);

}  // namespace graspdb::client
