// Rejects frames that are too old.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// Returns the frames of another sensor if they are fresh. Thread-safe.
class FreshSensor : public DepthSensor {
 public:
  FreshSensor(std::unique_ptr<DepthSensor> sensor, absl::Duration max_age)
      : sensor_(std::move(sensor)), max_age_(max_age) {}

  // The errors of the sensor; UNAVAILABLE when the frame is older than the limit.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override;
  bool IsReady() override { return sensor_->IsReady(); }
  bool HasEnded() override { return sensor_->HasEnded(); }
  std::string Name() const override { return sensor_->Name(); }

 private:
  const std::unique_ptr<DepthSensor> sensor_;
  const absl::Duration max_age_;
};

}  // namespace graspdb::client
