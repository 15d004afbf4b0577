// A camera that a test connects, unplugs and feeds with frames.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/frame_mailbox.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// A frame that is identified by its number.
inline SensorFrame NumberedFrame(int number, MonotonicTime time = MonotonicTime::Now()) {
  SensorFrame frame;
  v1::DepthImage image;
  image.set_data(std::to_string(number));
  frame.scan = std::move(image);
  SetTime(time, frame);
  return frame;
}

inline std::string DataOf(const SensorFrame& frame) {
  return std::visit([](const auto& scan) { return scan.data(); }, frame.scan);
}

// The cable: shared state of all sensors opened on it.
struct Cable {
  absl::Mutex mutex;
  bool plugged = false;
  int opened = 0;  // successful attempts to open the camera
  int open_now = 0;
  int max_open = 0;
  std::shared_ptr<FrameMailbox> frames;  // of the open sensor

  void Plug(bool in) {
    const absl::MutexLock lock(&mutex);
    plugged = in;
    if (!in && frames != nullptr) frames->Fail(absl::UnavailableError("pulled out"));
  }
  // Passes a frame to the open sensor; false if there is none.
  bool Expose(SensorFrame frame) {
    const absl::MutexLock lock(&mutex);
    if (frames == nullptr) return false;
    frames->Put(std::move(frame));
    return true;
  }
  int Opened() {
    const absl::MutexLock lock(&mutex);
    return opened;
  }
};

class ScriptedCamera : public DepthSensor {
 public:
  static absl::StatusOr<std::unique_ptr<DepthSensor>> Open(const std::shared_ptr<Cable>& cable) {
    const absl::MutexLock lock(&cable->mutex);
    if (!cable->plugged) return absl::UnavailableError("nothing is plugged in");
    ++cable->opened;
    cable->max_open = std::max(cable->max_open, ++cable->open_now);
    cable->frames = std::make_shared<FrameMailbox>(absl::Seconds(60));
    return std::unique_ptr<DepthSensor>(new ScriptedCamera(cable, cable->frames));
  }
  ~ScriptedCamera() override {
    const absl::MutexLock lock(&cable_->mutex);
    --cable_->open_now;
    cable_->frames = nullptr;
  }

  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override {
    return frames_->Wait(MonotonicTime::Now(), deadline);
  }
  bool IsReady() override { return frames_->IsAlive(); }
  std::string Name() const override { return "scripted camera"; }

 private:
  ScriptedCamera(std::shared_ptr<Cable> cable, std::shared_ptr<FrameMailbox> frames)
      : cable_(std::move(cable)), frames_(std::move(frames)) {}

  const std::shared_ptr<Cable> cable_;
  const std::shared_ptr<FrameMailbox> frames_;
};

}  // namespace graspdb::client
