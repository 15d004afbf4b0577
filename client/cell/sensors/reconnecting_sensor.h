// Reopens a camera after it was unplugged.
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
#include "program/base/monotonic_cond_var.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

using SensorFactory = std::function<absl::StatusOr<std::unique_ptr<DepthSensor>>()>;

struct ReconnectSettings {
  // The pause before an attempt to open the camera: doubled after every attempt up to the longest,
  // reset to the first after frames have come.
  absl::Duration first_pause = absl::Milliseconds(250);
  absl::Duration max_pause = absl::Seconds(5);
  // Period of checking an idle camera.
  absl::Duration watch = absl::Seconds(1);
};

// Opens a sensor in the background, and reopens it after it was UNAVAILABLE in Next or, while idle,
// not IsReady. At most one of the factory's sensors exists at a time. Thread-safe.
class ReconnectingSensor : public DepthSensor {
 public:
  // `open` runs on a thread of its own, and may be slow.
  ReconnectingSensor(std::string name, SensorFactory open, const ReconnectSettings& settings);
  // Waits for an attempt to open in progress. No call of Next may be in progress.
  ~ReconnectingSensor() override;
  ReconnectingSensor(const ReconnectingSensor&) = delete;
  ReconnectingSensor& operator=(const ReconnectingSensor&) = delete;

  // Waits for an attempt to open in progress. If there is none, and no camera, returns the error of
  // the last attempt at once, so that a robot need not wait.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override ABSL_LOCKS_EXCLUDED(mutex_);
  bool IsReady() override ABSL_LOCKS_EXCLUDED(mutex_);
  // The name of the sensor; `name` until it was opened for the first time.
  std::string Name() const override ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  void Run() ABSL_LOCKS_EXCLUDED(mutex_);
  void Open() ABSL_LOCKS_EXCLUDED(mutex_);
  void WatchUntilLost() ABSL_LOCKS_EXCLUDED(mutex_);
  void Close() ABSL_LOCKS_EXCLUDED(mutex_);
  void Pause(absl::Duration time) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status WaitForSensor(MonotonicTime deadline) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const SensorFactory open_;
  const ReconnectSettings settings_;
  mutable absl::Mutex mutex_;
  MonotonicCondVar changed_;
  std::string name_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<DepthSensor> sensor_ ABSL_GUARDED_BY(mutex_);
  int callers_ ABSL_GUARDED_BY(mutex_) = 0;  // in the sensor's Next
  bool opening_ ABSL_GUARDED_BY(mutex_) = true;
  bool lost_ ABSL_GUARDED_BY(mutex_) = false;
  bool gave_frames_ ABSL_GUARDED_BY(mutex_) = false;  // since it was opened
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Status why_ ABSL_GUARDED_BY(mutex_);  // why there is no sensor
  std::thread thread_;
};

}  // namespace graspdb::client
