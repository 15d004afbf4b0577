#include "client/cell/sensors/reconnecting_sensor.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/log/log_field.h"

namespace graspdb::client {

ReconnectingSensor::ReconnectingSensor(std::string name, SensorFactory open,
                                       const ReconnectSettings& settings)
    : open_(std::move(open)), settings_(settings), name_(std::move(name)) {
  thread_ = std::thread([this] { Run(); });
}

ReconnectingSensor::~ReconnectingSensor() {
  {
    const absl::MutexLock lock(&mutex_);
    stopping_ = true;
    changed_.SignalAll();
  }
  thread_.join();
}

void ReconnectingSensor::Run() {
  absl::Duration pause = settings_.first_pause;
  const auto is_stopping = [this] {
    const absl::MutexLock lock(&mutex_);
    return stopping_;
  };
  while (!is_stopping()) {
    Open();
    WatchUntilLost();
    Close();
    {
      const absl::MutexLock lock(&mutex_);
      if (gave_frames_) pause = settings_.first_pause;
    }
    Pause(pause);
    pause = std::min(2 * pause, settings_.max_pause);
  }
}

void ReconnectingSensor::Open() {
  {
    const absl::MutexLock lock(&mutex_);
    opening_ = true;
  }
  absl::StatusOr<std::unique_ptr<DepthSensor>> opened = open_();
  const absl::MutexLock lock(&mutex_);
  opening_ = false;
  gave_frames_ = false;
  if (opened.ok()) {
    sensor_ = *std::move(opened);
    name_ = sensor_->Name();
    why_ = absl::OkStatus();
    lost_ = false;
    spdlog::info("event=camera_opened camera={}", LogField(name_));
  } else {
    // Logged once per reason, so that a long outage does not fill the log.
    if (why_ != opened.status()) {
      spdlog::warn("event=camera_not_opened camera={} error={}", LogField(name_),
                   LogField(std::string(opened.status().message())));
    }
    why_ = opened.status();
  }
  changed_.SignalAll();
}

void ReconnectingSensor::WatchUntilLost() {
  const absl::MutexLock lock(&mutex_);
  while (sensor_ != nullptr && !lost_ && !stopping_) {
    if (!changed_.WaitUntil(&mutex_, MonotonicTime::Now() + settings_.watch)) continue;
    if (sensor_->IsReady()) {
      gave_frames_ = true;
      continue;
    }
    lost_ = true;
    why_ = absl::UnavailableError(
        absl::StrCat(name_, " gives no frames any more; check its cable and its power supply"));
  }
}

void ReconnectingSensor::Close() {
  std::unique_ptr<DepthSensor> gone;
  {
    const absl::MutexLock lock(&mutex_);
    if (sensor_ == nullptr) return;
    if (lost_) {
      spdlog::warn("event=camera_lost camera={} error={}", LogField(name_),
                   LogField(std::string(why_.message())));
    }
    while (callers_ > 0) changed_.Wait(&mutex_);
    gone = std::move(sensor_);
  }
}

void ReconnectingSensor::Pause(absl::Duration time) {
  const MonotonicTime end = MonotonicTime::Now() + time;
  const absl::MutexLock lock(&mutex_);
  while (!stopping_ && MonotonicTime::Now() < end) changed_.WaitUntil(&mutex_, end);
}

absl::Status ReconnectingSensor::WaitForSensor(MonotonicTime deadline) {
  while (opening_ && MonotonicTime::Now() < deadline) changed_.WaitUntil(&mutex_, deadline);
  if (opening_) {
    return why_.ok() ? absl::UnavailableError(
                           absl::StrCat(name_, " is still being opened; try again in a moment"))
                     : why_;
  }
  return sensor_ == nullptr || lost_ ? why_ : absl::OkStatus();
}

absl::StatusOr<SensorFrame> ReconnectingSensor::Next(MonotonicTime deadline) {
  DepthSensor* sensor = nullptr;
  {
    const absl::MutexLock lock(&mutex_);
    RETURN_IF_ERROR(WaitForSensor(deadline));
    ++callers_;  // keeps the sensor alive until they return
    sensor = sensor_.get();
  }
  absl::StatusOr<SensorFrame> frame = sensor->Next(deadline);
  const absl::MutexLock lock(&mutex_);
  --callers_;
  if (frame.ok()) gave_frames_ = true;
  if (absl::IsUnavailable(frame.status()) && !lost_) {
    lost_ = true;
    why_ = frame.status();
  }
  changed_.SignalAll();
  return frame;
}

bool ReconnectingSensor::IsReady() {
  const absl::MutexLock lock(&mutex_);
  return sensor_ != nullptr && !lost_ && sensor_->IsReady();
}

std::string ReconnectingSensor::Name() const {
  const absl::MutexLock lock(&mutex_);
  return name_;
}

}  // namespace graspdb::client
