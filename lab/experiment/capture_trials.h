// Captures of a set as an experiment.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "lab/experiment/trial_source.h"

namespace graspdb::client {

struct CaptureTrials {
  PartSet set;  // stable poses with captures that are taught come first; shapes may be null
  ExperimentTrials trials;
};

// The capture set in `folder`: captures of an object are taught unless they are for QUERY;
// those for QUERY are asked, of which those of no object or of one that is not taught must be
// refused. With `leave_one_out` each taught capture is asked while it is not taught. Clouds are
// read when they are needed. Errors as LoadCaptureSet and LoadMesh; FAILED_PRECONDITION when
// nothing is to be taught or asked.
absl::StatusOr<CaptureTrials> LoadCaptureTrials(const std::filesystem::path& folder,
                                                bool leave_one_out);

}  // namespace graspdb::client
