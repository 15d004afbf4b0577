// Captures of a set as an experiment.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "lab/experiment/trials/cases.h"

namespace graspdb::lab {

struct CaptureTrials {
  PartSet set;  // stable poses with taught captures come first; shapes may be null
  ExperimentTrials trials;
};

// The capture set in `folder`: captures of an object are taught unless they are for QUERY; those
// for QUERY are recognized, and must be rejected if they have no object or one that is not taught.
// With `leave_one_out` each taught capture is recognized without its own view. Clouds are read on
// demand; one in millimetres is then INVALID_ARGUMENT. Errors as LoadCaptureSet and
// LoadMeshInMetres; FAILED_PRECONDITION when there is nothing to teach or to recognize;
// INVALID_ARGUMENT when a file of an object is taught and recognized.
absl::StatusOr<CaptureTrials> LoadCaptureTrials(const std::filesystem::path& folder,
                                                bool leave_one_out);

}  // namespace graspdb::lab
