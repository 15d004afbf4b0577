// Grasps that are given for an object, in a file.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"
#include "graspdb/v1/catalog.pb.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// A file of grasps has up to this many bytes: 64 grasps are some 20 kB.
inline constexpr std::size_t kMaxGraspsFileBytes = 1 << 20;

// The grasps of a JSON document {"grasps": [GRASP, ...]}, as a capture set declares them.
// NOT_FOUND for no file; INVALID_ARGUMENT for one that is too large, is no such document, has none,
// or has a grasp that a capture set may not have.
absl::StatusOr<std::vector<v1::Grasp>> LoadGrasps(const std::filesystem::path& path);

// INVALID_ARGUMENT for a grasp with a free turn: that is about the z axis of an object's frame, of
// which the mesh's knows nothing.
absl::Status CheckForMesh(const std::vector<v1::Grasp>& grasps);

// `grasp` with its pose T_mesh_tcp as T_object_tcp.
v1::Grasp FromMesh(v1::Grasp grasp, const recognition::Pose& object_mesh);

// Why a grasp (T_object_tcp) cannot be taken while the object stands on the table z = 0: it comes
// from below, or its tool centre point or the begin of its approach is not kOffTableM above the
// table. Empty where it can. The gripper's own shape is not known.
std::string WhyOutOfReach(const v1::Grasp& grasp);

// `grasps` with `added`: those of the same id are replaced in their place, others come last.
std::vector<v1::Grasp> Merged(std::vector<v1::Grasp> grasps, const std::vector<v1::Grasp>& added);

}  // namespace graspdb::client
