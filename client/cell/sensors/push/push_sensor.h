// Cameras whose frames another program pushes, with the SDK of their vendor.
#pragma once

#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/sensor_settings.h"

namespace graspdb::client {

// A gRPC server with graspdb.v1.FrameService.
class PushSensor : public DepthSensor {
 public:
  // Listens at once. `where`: PORT, on this machine only, or HOST:PORT; port 0 picks one.
  // `allow_remote`: other machines may push, without encryption or password. INVALID_ARGUMENT for
  // another `where`; FAILED_PRECONDITION when other machines could push without allow_remote, and
  // when it cannot listen there.
  static absl::StatusOr<std::unique_ptr<PushSensor>> Listen(const std::string& where,
                                                            bool allow_remote,
                                                            const SensorSettings& settings);
  // No call of Next may be in progress.
  ~PushSensor() override;
  PushSensor(const PushSensor&) = delete;
  PushSensor& operator=(const PushSensor&) = delete;

  // UNAVAILABLE at once where no frame has come for settings.silence.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override;
  bool IsReady() override;
  std::string Name() const override;

  // HOST:PORT with the actual port.
  const std::string& address() const;

 private:
  class Server;
  explicit PushSensor(std::unique_ptr<Server> server);
  const std::unique_ptr<Server> server_;
};

}  // namespace graspdb::client
