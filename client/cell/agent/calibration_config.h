// How the hand-eye calibrations of a cell are set up.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/calibration/hand_eye_session.h"

namespace graspdb::client {

struct CalibrationConfig {
  int pipeline = 0;
  HandEyeSetup setup;
};

// A calibration as a line of text: its pipeline's number, then words.
//   0 target=calibration-block mount=fixed region=0.3
//   1 target=calibration-block mount=flange frames=10
// `cell` is a resource name. INVALID_ARGUMENT, with the line and what may stand there, where it is
// none, or where two have the same number.
absl::StatusOr<std::vector<CalibrationConfig>> ParseCalibrations(
    const std::vector<std::string>& lines, const std::string& cell);

// How to write them, for --help.
std::string CalibrationHelp();

}  // namespace graspdb::client
