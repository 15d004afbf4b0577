// Runs `graspdb eval`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "lab/experiment/trials/part_set.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "recognition/matching/matching_parameters.h"

namespace graspdb::lab {

struct EvalArguments {
  // Mesh files, or one folder: a capture set or frames of real cameras.
  std::vector<std::string> inputs;
  bool leave_one_out = false;  // of a capture set
  Choices choices;
  std::vector<std::string> cases;
  double unit_m = 1;
  MeshSelection selection{.orientations = 3};
  int trials = 24;
  std::uint64_t seed = 1;
  recognition::MatchingParameters matching;
  bool own_thresholds = false;
  bool descriptors = false;
  bool without_image = false;   // not SceneParameters::verify
  bool without_search = false;  // not SceneParameters::search
  int composited = 0;           // scenes to render into each frame; 0: the frames as they are
  bool list = false;
  std::string out;      // folder; empty: no report
  std::string command;  // to repeat the run
};

// Runs the cases, prints their figures, writes the report if requested. INVALID_ARGUMENT for inputs
// that cannot be combined; errors as those of the cases.
absl::Status RunEval(const EvalArguments& arguments);

}  // namespace graspdb::lab
