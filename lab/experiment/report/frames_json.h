// What was found in frames of real cameras, for programs.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/real_frames.h"

namespace graspdb::client {

// {"command", "frames": [{"name", "sensor", "arrangement", "error", "ms", "objects",
// "detections"}]}, laid out as ReportJson. INTERNAL when the library refuses it.
absl::StatusOr<std::string> FramesJson(const std::string& command,
                                       const std::vector<FrameResult>& results);

}  // namespace graspdb::client
