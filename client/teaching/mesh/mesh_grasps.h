// Grasps of an object from a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/catalog.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// Maximum size of a grasps file, bytes: 64 grasps are some 20 kB.
inline constexpr std::size_t kMaxGraspsFileBytes = 1 << 20;

// The grasps of a JSON document {"grasps": [GRASP, ...]}, as a capture set declares them.
// NOT_FOUND for no file, FAILED_PRECONDITION for one that cannot be read; INVALID_ARGUMENT for one
// that is too large, is not such a document, has no grasps, or has a grasp that is invalid in a
// capture set or whose id the server would reject.
absl::StatusOr<std::vector<v1::Grasp>> LoadGrasps(const std::filesystem::path& path);

// INVALID_ARGUMENT for a grasp with a free turn: it is about the z axis of the object's frame,
// which is not defined in the mesh's frame.
absl::Status CheckForMesh(const std::vector<v1::Grasp>& grasps);

// `grasp` with its pose T_mesh_tcp as T_object_tcp.
v1::Grasp FromMesh(v1::Grasp grasp, const recognition::Pose& object_mesh);

// Why a grasp (T_object_tcp) cannot be taken while the object stands on the table z = 0: it comes
// from below, or its tool centre point or the start of its approach is not kOffTableM above the
// table. Empty if it can. The gripper's shape is not considered.
std::string WhyOutOfReach(const v1::Grasp& grasp);

// `grasps` with `added`: those of the same id are replaced in their place, others come last.
std::vector<v1::Grasp> Merged(std::vector<v1::Grasp> grasps, const std::vector<v1::Grasp>& added);

}  // namespace graspdb::client
