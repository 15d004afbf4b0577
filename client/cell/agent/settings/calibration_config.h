// Settings of a cell's hand-eye calibrations.
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

// A calibration as a line of text: its pipeline number, then words.
//   0 target=calibration-block mount=fixed region=0.3
//   1 target=calibration-block mount=flange frames=10
// `cell` is a resource name. INVALID_ARGUMENT, with the line and the allowed words, for an invalid
// line or two with the same number.
absl::StatusOr<std::vector<CalibrationConfig>> ParseCalibrations(
    const std::vector<std::string>& lines, const std::string& cell);

// Their syntax, for --help.
std::string CalibrationHelp();

}  // namespace graspdb::client
