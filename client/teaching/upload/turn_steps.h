// The steps of a turn of an object about itself.
#pragma once

#include "absl/status/status.h"

namespace graspdb::client {

// INVALID_ARGUMENT for a step that is not between 1 and 120 degrees.
absl::Status CheckStep(double step_deg);

// The number of steps 0, step, 2 step, … below 360 degrees; 0 for a step that CheckStep rejects.
int StepsOf(double step_deg);

}  // namespace graspdb::client
