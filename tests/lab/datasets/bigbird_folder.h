// Folders in BigBIRD's layout, from simulated cameras, for tests.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "recognition/base/types.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

struct BigBirdPlan {
  int step_deg = 15;                           // of the turntable
  std::vector<std::string> cameras = {"NP3"};  // that took something; all five are calibrated
  bool with_clouds = true;                     // segmented ones; otherwise depth maps
  bool with_meshes = false;
  bool upside_down = false;  // z of the table's frame in the files points down
};

// Writes the folder of each part into `folder`, named after the object: five cameras without noise,
// each with its infrared camera beside the RGB camera, around a turntable that starts at 20
// degrees.
absl::Status WriteBigBird(const std::filesystem::path& folder, const std::vector<Workpiece>& parts,
                          const BigBirdPlan& plan);

// T_table_part of every part, in the table's frame with z up: beside the axis.
recognition::Pose TablePart();

}  // namespace graspdb::client
