// `graspdb eval` on frames of real cameras.
#pragma once

#include "absl/status/status.h"
#include "lab/commands/eval_run.h"

namespace graspdb::client {

// Teaches the meshes that the frames in `arguments.inputs` name, asks each frame, prints what was
// found, what was accepted wrongly and, of what was not found, which step lost it. Errors as
// LoadFrames, FramesCatalogue::Teach and AskFrame.
absl::Status RunFrames(const EvalArguments& arguments);

}  // namespace graspdb::client
