// The workpieces that an experiment is about.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/judge.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Workpieces with what answers about them are measured with; position by position.
struct PartSet {
  std::vector<Workpiece> parts;
  std::vector<std::shared_ptr<const MeasuredShape>> shapes;  // null: that of what is taught
  // T_object_mesh: from the mesh as it was given into the frame of the stable pose. All stable
  // poses of an object are one mesh.
  std::vector<recognition::Pose> object_mesh;
  // The first so many are taught; the others are only shown.
  std::size_t taught_count = 0;
  // Parts that questions are about, by their position, one question each; empty: all parts in turn.
  std::vector<std::size_t> asked;

  void Add(const PartSet& other, std::size_t position);
  // Measures the part with its mesh, where it has one.
  void Add(Workpiece part, const recognition::Pose& mesh_pose);
  // Whether the part's object was taught, in whatever stable pose.
  bool Knows(std::size_t position) const;
};

// Which meshes and orientations an experiment takes.
struct MeshSelection {
  int orientations = 1;           // at most, the most probable first
  double min_probability = 0.05;  // of an orientation, see MeshStablePose
};

// The mesh files `paths` (one unit is `unit_scale_m` metres) as workpieces on the table: the
// object is named after the file, the stable poses "resting-1", "resting-2", … All count as taught.
// Errors as LoadPartMesh and FindStablePoses.
absl::StatusOr<PartSet> RestingParts(const std::vector<std::filesystem::path>& paths,
                                     double unit_scale_m, const MeshSelection& selection);

// Sample parts that are each other's mirror images, among others.
PartSet TwinParts();

// Which of the parts at hand a case is about.
enum class PartChoice {
  kMain,        // those named, in the orientation in which they most often rest
  kEverything,  // all of them, in every orientation
  kRound,       // those that look the same from all sides
  kStrangers,   // as kMain; all others are shown, but not taught
  kTwins,       // none of them: TwinParts
  kDropPoses,   // all of them, but taught from the meshes: DropPoses
};

struct Choices {
  // Objects of the main cases; empty stands for all that are not round.
  std::vector<std::string> main = {};
  // Of objects in kEverything: the diameter.
  double min_length_m = 0.04;
  double max_length_m = 0.30;
};

// Not for kDropPoses. INVALID_ARGUMENT when a named object is not there, FAILED_PRECONDITION when
// nothing is left.
absl::StatusOr<PartSet> Choose(const PartSet& all, PartChoice choice, const Choices& choices);

}  // namespace graspdb::client
