// Runs `graspdb eval`.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "lab/experiment/real_frames.h"
#include "lab/experiment/trials/part_set.h"
#include "pictures/shaded_picture.h"
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

// Teaches the meshes of the frames in `arguments.inputs`, recognizes each frame, prints found
// objects, false detections and, for missed objects, the step that lost them. Errors as LoadFrames,
// FramesCatalogue::Teach and RecognizeFrame.
absl::Status RunFrames(const EvalArguments& arguments);

// The scan (sensor frame, m) from its camera, darker where it is farther, and the visible points of
// the posed models: of right answers green, of wrong ones red, of objects that were not found, at
// their true pose, yellow. Measurements that are not finite or behind the camera are left out;
// pixels without one are black. O(n) in the points.
pictures::ShadedPicture DrawFrame(const FrameResult& result, const recognition::Points& scan);

}  // namespace graspdb::lab
