#include "client/cell/agent/calibrations.h"

#include <memory>

namespace graspdb::client {

Calibrations::Calibrations(const std::vector<CalibrationConfig>& configs, Client& client,
                           DepthSensor& sensor, CellCache& cell)
    : cell_(cell) {
  for (const CalibrationConfig& config : configs) {
    sessions_.Add(config.pipeline, std::make_unique<HandEyeSession>(client, sensor, config.setup));
  }
}

absl::StatusOr<CalibrationReport> Calibrations::Calibrate(int pipeline) {
  absl::StatusOr<CalibrationReport> report = sessions_.Calibrate(pipeline);
  if (!report.ok()) return report;
  if (absl::Status read = cell_.Refresh(); !read.ok()) return read;
  return report;
}

}  // namespace graspdb::client
