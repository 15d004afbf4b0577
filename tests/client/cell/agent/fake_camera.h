// A camera with scripted frames.
#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <utility>

#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

class FakeCamera : public DepthSensor {
 public:
  using Give = std::function<absl::StatusOr<SensorFrame>()>;
  explicit FakeCamera(Give give) : give_(std::move(give)) {}

  absl::StatusOr<SensorFrame> Next(MonotonicTime /*deadline*/) override {
    ++calls;
    return give_();
  }
  bool IsReady() override { return ready; }
  std::string Name() const override { return "fake camera"; }

  std::atomic<int> calls = 0;
  std::atomic<bool> ready = true;

 private:
  const Give give_;
};

}  // namespace graspdb::client
