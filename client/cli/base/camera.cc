#include "client/cli/base/camera.h"

#include <utility>

#include "client/cell/sensors/kinds/open_sensor.h"
#include "client/cli/base/command.h"

namespace graspdb::client {
namespace {

class Camera : public DepthSensor {
 public:
  explicit Camera(std::unique_ptr<DepthSensor> sensor) : sensor_(std::move(sensor)) {}

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    absl::StatusOr<SensorFrame> frame = sensor_->Next(deadline);
    if (!frame.ok()) return NotOfServer(frame.status());
    return frame;
  }
  bool IsReady() override { return sensor_->IsReady(); }
  bool HasEnded() override { return sensor_->HasEnded(); }
  std::string Name() const override { return sensor_->Name(); }

 private:
  const std::unique_ptr<DepthSensor> sensor_;
};

}  // namespace

absl::Status NotOfServer(const absl::Status& status) {
  if (!absl::IsUnavailable(status)) return status;
  return absl::FailedPreconditionError(status.message());
}

absl::Status NotOpened(const absl::Status& status) {
  return absl::IsInvalidArgument(status) ? WrongUsage(status) : NotOfServer(status);
}

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenCamera(const std::string& spec) {
  absl::StatusOr<std::unique_ptr<DepthSensor>> sensor = OpenSensor(spec, SensorSettings());
  if (!sensor.ok()) return NotOpened(sensor.status());
  return std::make_unique<Camera>(*std::move(sensor));
}

}  // namespace graspdb::client
