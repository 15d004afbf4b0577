// A camera that is plugged in again is found again.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"

namespace graspdb::client {

using SensorFactory = std::function<absl::StatusOr<std::unique_ptr<DepthSensor>>()>;

struct ReconnectSettings {
  // The pause before an attempt to open the camera: the first, doubled after every attempt up to
  // the longest. It starts again with the first one when frames have come.
  absl::Duration first_pause = absl::Milliseconds(250);
  absl::Duration longest_pause = absl::Seconds(5);
  // How often a camera that nobody asks is looked after.
  absl::Duration watch = absl::Seconds(1);
};

// Opens a sensor in the background, and closes and opens it again after it was UNAVAILABLE: to a
// caller, or by IsReady while nobody asked. Never two of the factory's sensors are there at once.
// Thread-safe.
class ReconnectingSensor : public DepthSensor {
 public:
  // `open` runs on a thread of its own, and may take its time.
  ReconnectingSensor(std::string name, SensorFactory open, const ReconnectSettings& settings);
  // Waits for an attempt to open that is under way. Nobody may be in Next any more.
  ~ReconnectingSensor() override;
  ReconnectingSensor(const ReconnectingSensor&) = delete;
  ReconnectingSensor& operator=(const ReconnectingSensor&) = delete;

  // Waits for the end of an attempt to open that is under way. Where none is, and no camera, the
  // error of the last one comes at once: a robot is told sooner.
  absl::StatusOr<SensorFrame> Next(absl::Time deadline) override ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsReady() override ABSL_LOCKS_EXCLUDED(mutex_);
  // As the sensor calls itself; before it was there for the first time, `name`.
  std::string Name() const override ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  void Run() ABSL_LOCKS_EXCLUDED(mutex_);
  void Open() ABSL_LOCKS_EXCLUDED(mutex_);
  void WatchUntilLost() ABSL_LOCKS_EXCLUDED(mutex_);
  void Close() ABSL_LOCKS_EXCLUDED(mutex_);
  void Pause(absl::Duration time) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status WaitForSensor(absl::Time deadline) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const SensorFactory open_;
  const ReconnectSettings settings_;
  mutable absl::Mutex mutex_;
  absl::CondVar changed_;
  std::string name_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<DepthSensor> sensor_ ABSL_GUARDED_BY(mutex_);
  int callers_ ABSL_GUARDED_BY(mutex_) = 0;  // in the sensor's Next
  bool opening_ ABSL_GUARDED_BY(mutex_) = true;
  bool lost_ ABSL_GUARDED_BY(mutex_) = false;
  bool gave_frames_ ABSL_GUARDED_BY(mutex_) = false;  // since it was opened
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Status why_ ABSL_GUARDED_BY(mutex_);  // there is no sensor
  std::thread thread_;
};

}  // namespace graspdb::client
