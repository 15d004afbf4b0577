#include "client/teaching/upload/turn_steps.h"

#include <cmath>

namespace graspdb::client {

absl::Status CheckStep(double step_deg) {
  if (step_deg >= 1 && step_deg <= 120) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "the step of the turntable is not between 1 and 120 degrees; the usual one is 20");
}

int StepsOf(double step_deg) {
  if (!CheckStep(step_deg).ok()) return 0;
  return static_cast<int>(std::ceil(360 / step_deg - 1e-9));  // 360 itself is 0 again
}

}  // namespace graspdb::client
