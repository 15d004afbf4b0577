// An object's folder in the layout of BigBIRD: Singh, Sha, Narayan, Achim and Abbeel, "BigBIRD: A
// Large-Scale 3D Database of Object Instances", ICRA 2014. The YCB set has the same.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/datasets/depth_map.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// The object on its turntable, as one camera saw it after one turn. The world is the table's frame
// at the object's first turn, so that the cameras stand still: z is up, and 0 on the table. The
// table's frame turns with the object.
struct BigBirdView {
  std::string camera;  // "NP1" … "NP5"
  int turn_deg = 0;
  std::filesystem::path path;     // of a segmented cloud, or of a depth map
  std::optional<DepthLens> lens;  // of the camera that took the depth map; none: a cloud
  recognition::Pose world_table = recognition::Pose::Identity();   // a turn about z
  recognition::Pose world_sensor = recognition::Pose::Identity();  // of the points, T_world_sensor
};

struct BigBirdObject {
  std::string id;                  // what its folder is called
  std::vector<BigBirdView> views;  // camera by camera, the smallest turn first
  std::filesystem::path mesh;      // of the whole object; empty: there is none
  // T_table_mesh: the mesh is in the table's frame of the files, which may have z down.
  recognition::Pose table_mesh = recognition::Pose::Identity();
};

// Whether `folder` is the folder of an object.
bool IsBigBirdObject(const std::filesystem::path& folder);

// What there is in `folder` of `cameras`: the clouds, or where there are none of these the depth
// maps. Reads calibration and poses, no points. On which side of the table is up is where the
// cameras are.
//
// FAILED_PRECONDITION when there is neither a cloud nor a depth map; errors of
// bigbird_calibration.h, also when there is no pose for a turn that was seen. Thread-safe.
absl::StatusOr<BigBirdObject> LoadBigBirdObject(const std::filesystem::path& folder,
                                                const std::vector<std::string>& cameras);

}  // namespace graspdb::client
