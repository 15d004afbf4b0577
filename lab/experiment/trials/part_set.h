// Workpieces of an experiment: as they are taught, and as they are shown.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/pose_error.h"
#include "rendering/workpiece.h"

namespace graspdb::lab {

// Workpieces and their shapes for measuring answers, by position.
struct PartSet {
  std::vector<rendering::Workpiece> parts;
  std::vector<std::shared_ptr<const rendering::MeasuredShape>>
      shapes;  // null: from the taught model
  // T_object_mesh: from the mesh file to the frame of the stable pose. All stable poses of an
  // object have one mesh.
  std::vector<recognition::Pose> object_mesh;
  // The first ones are taught; the others are only shown.
  std::size_t taught_count = 0;
  // Parts of the queries, by their position, one query each; empty: all parts in turn.
  std::vector<std::size_t> queried_parts;

  void Add(const PartSet& other, std::size_t position);
  // Measures the part by its mesh, if it has one.
  void Add(rendering::Workpiece part, const recognition::Pose& mesh_pose);
  // Whether the part's object was taught, in any stable pose.
  bool IsTaught(std::size_t position) const;
};

// Meshes and orientations of an experiment.
struct MeshSelection {
  int orientations = 1;           // at most, the most probable first
  double min_probability = 0.05;  // of an orientation, see MeshStablePose
};

// The mesh files `paths` (one unit is `unit_scale_m` metres) as workpieces on the table: the
// object is named after the file, the stable poses "resting-1", "resting-2", … All count as taught.
// INVALID_ARGUMENT when two files have one id; errors as LoadPartMesh and FindStablePoses.
absl::StatusOr<PartSet> RestingParts(const std::vector<std::filesystem::path>& paths,
                                     double unit_scale_m, const MeshSelection& selection);

// Sample parts that are each other's mirror images, among others.
PartSet TwinParts();

// Parts of a case.
enum class PartChoice {
  kMain,        // those named, in the orientation in which they most often rest
  kEverything,  // all of them, in every orientation
  kRound,       // those that look the same from all sides
  kStrangers,   // as kMain; all others are shown, but not taught
  kTwins,       // none of them: TwinParts
  kDropPoses,   // all of them, but taught from the meshes: DropPoses
};

struct Choices {
  // Objects of the main cases; empty: all that are not round.
  std::vector<std::string> main = {};
  // Of objects in kEverything: the diameter.
  double min_length_m = 0.04;
  double max_length_m = 0.30;
};

// Not for kDropPoses. INVALID_ARGUMENT when a named object is missing, FAILED_PRECONDITION when no
// part is left.
absl::StatusOr<PartSet> Choose(const PartSet& all, PartChoice choice, const Choices& choices);

struct DropPoseSelection {
  // Smaller and larger meshes are left out, by their diameter.
  double min_length_m = 0.04;
  double max_length_m = 0.30;
  int falls = 24;  // of each mesh
  std::uint64_t seed = 1;
};

// The mesh files `paths` (one unit is `unit_scale_m` metres). The taught stable poses and
// symmetries are those that `graspdb teach --mesh` proposes. The queries show each mesh on a facet
// on which it comes to rest, drawn by its probability among all of them (RestingFacets), including
// rare ones and those that were grouped under another one; these are called "drop-1", "drop-2",
// … FAILED_PRECONDITION when no mesh is left; errors as LoadPartMesh and ProposeCadPart.
absl::StatusOr<PartSet> DropPoses(const std::vector<std::filesystem::path>& paths,
                                  double unit_scale_m, const DropPoseSelection& selection);

}  // namespace graspdb::lab
