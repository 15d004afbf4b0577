// `graspdb eval` on frames of real cameras.
#pragma once

#include "absl/status/status.h"
#include "lab/commands/eval_run.h"

namespace graspdb::lab {

// Teaches the meshes of the frames in `arguments.inputs`, recognizes each frame, prints found
// objects, false detections and, for missed objects, the step that lost them. Errors as LoadFrames,
// FramesCatalogue::Teach and RecognizeFrame.
absl::Status RunFrames(const EvalArguments& arguments);

}  // namespace graspdb::lab
