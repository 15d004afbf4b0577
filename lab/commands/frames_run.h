// `graspdb eval` on frames of real cameras.
#pragma once

#include "absl/status/status.h"
#include "lab/commands/eval_run.h"
#include "lab/experiment/real_frames.h"
#include "pictures/shaded_picture.h"

namespace graspdb::lab {

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
