// A camera that a test plugs in, pulls out and makes frames for.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/frame_mailbox.h"

namespace graspdb::client {

// A frame that can be told from others.
inline SensorFrame NumberedFrame(int number, absl::Time time = absl::Now()) {
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

// The cable: what all sensors opened on it have in common.
struct Cable {
  absl::Mutex mutex;
  bool plugged = false;
  int opened = 0;  // attempts that found the camera
  int open_now = 0;
  int most_open = 0;
  std::shared_ptr<FrameMailbox> frames;  // of the sensor that is open

  void Plug(bool in) {
    const absl::MutexLock lock(&mutex);
    plugged = in;
    if (!in && frames != nullptr) frames->Fail(absl::UnavailableError("pulled out"));
  }
  // Gives a frame to the sensor that is open; false where none is.
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
    cable->most_open = std::max(cable->most_open, ++cable->open_now);
    cable->frames = std::make_shared<FrameMailbox>(absl::Seconds(60));
    return std::unique_ptr<DepthSensor>(new ScriptedCamera(cable, cable->frames));
  }
  ~ScriptedCamera() override {
    const absl::MutexLock lock(&cable_->mutex);
    --cable_->open_now;
    cable_->frames = nullptr;
  }

  absl::StatusOr<SensorFrame> Next(absl::Time deadline) override {
    return frames_->Wait(absl::Now(), deadline);
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
