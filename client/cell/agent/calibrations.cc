#include "client/cell/agent/calibrations.h"

#include <memory>

#include "base/status_macros.h"

namespace graspdb::client {

Calibrations::Calibrations(const std::vector<CalibrationConfig>& configs, Client& client,
                           DepthSensor& sensor, CellCache& cell)
    : cell_(cell) {
  for (const CalibrationConfig& config : configs) {
    sessions_.Add(config.pipeline, std::make_unique<HandEyeSession>(client, sensor, config.setup));
  }
}

absl::StatusOr<CalibrationReport> Calibrations::Calibrate(int pipeline) {
  ASSIGN_OR_RETURN(CalibrationReport report, sessions_.Calibrate(pipeline));
  RETURN_IF_ERROR(cell_.Refresh());
  return report;
}

}  // namespace graspdb::client
