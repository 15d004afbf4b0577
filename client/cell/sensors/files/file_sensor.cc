#include "client/cell/sensors/files/file_sensor.h"

#include <algorithm>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "files/scan_file.h"

namespace graspdb::client {
namespace {

namespace fs = std::filesystem;

}  // namespace

FileSensor::FileSensor(std::string name, std::vector<Entry> entries, const FilePlayback& playback)
    : name_(std::move(name)), entries_(std::move(entries)), playback_(playback) {}

absl::StatusOr<std::vector<FileSensor::Entry>> FileSensor::List(const fs::path& path) {
  std::vector<Entry> entries;
  std::error_code error;
  if (fs::exists(path / files::kCaptureSetFile, error)) {
    ASSIGN_OR_RETURN(const v1::CaptureSet set, files::LoadCaptureSet(path));
    entries.reserve(static_cast<std::size_t>(set.captures_size()));
    for (const v1::Capture& capture : set.captures()) {
      Entry& entry = entries.emplace_back(Entry{.path = path / capture.path(), .world_sensor = {}});
      if (capture.has_sensor_pose()) entry.world_sensor = files::FromMessage(capture.sensor_pose());
    }
    return entries;
  }
  for (fs::directory_iterator file(path, error), end; !error && file != end;
       file.increment(error)) {
    if (files::IsScanFile(file->path()))
      entries.push_back({.path = file->path(), .world_sensor = {}});
  }
  if (error) {
    return absl::FailedPreconditionError(
        absl::StrCat("cannot list ", path.string(), ": ", error.message()));
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.path < b.path; });
  return entries;
}

absl::StatusOr<std::unique_ptr<FileSensor>> FileSensor::Open(const fs::path& path,
                                                             const FilePlayback& playback) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return absl::NotFoundError(absl::StrCat(
        path.string(), " does not exist; give a folder, a capture set or a file to play"));
  }
  std::vector<Entry> entries = {{.path = path, .world_sensor = {}}};
  if (fs::is_directory(path, error)) {
    ASSIGN_OR_RETURN(entries, List(path));
  }
  if (entries.empty() || !files::IsScanFile(entries.front().path)) {
    return absl::FailedPreconditionError(absl::StrCat(
        path.string(), " has nothing to play; .pcd, .ply and 16-bit .png files are supported"));
  }
  return std::unique_ptr<FileSensor>(
      new FileSensor(absl::StrCat("files of ", path.string()), std::move(entries), playback));
}

absl::StatusOr<FileSensor::Entry> FileSensor::Take(MonotonicTime deadline) {
  MonotonicTime due = MonotonicTime::Now();
  Entry entry;
  {
    const absl::MutexLock lock(&mutex_);
    if (next_ == entries_.size()) {
      if (!playback_.loop) {
        return absl::UnavailableError(absl::StrCat(name_, ": all ", entries_.size(),
                                                   " were played; add ?loop to start again"));
      }
      next_ = 0;
    }
    due = std::max(due_, due);
    if (due > deadline) {
      return absl::DeadlineExceededError(
          absl::StrCat("the next of the ", name_, " is not due yet; use a later deadline"));
    }
    if (playback_.rate_hz > 0) due_ = due + absl::Seconds(1 / playback_.rate_hz);
    entry = entries_[next_++];
  }
  absl::SleepFor(due - MonotonicTime::Now());
  return entry;
}

absl::StatusOr<SensorFrame> FileSensor::Next(MonotonicTime deadline) {
  ASSIGN_OR_RETURN(const Entry entry, Take(deadline));
  const MonotonicTime time = MonotonicTime::Now();
  ASSIGN_OR_RETURN(files::ScanFile file, files::ReadScanFile(entry.path));
  SensorFrame frame{.scan = std::move(file.scan), .world_sensor = file.sensor_pose};
  SetTime(time, frame);
  if (entry.world_sensor) frame.world_sensor = entry.world_sensor;
  return frame;
}

bool FileSensor::IsReady() {
  const absl::MutexLock lock(&mutex_);
  return playback_.loop || next_ < entries_.size();
}

}  // namespace graspdb::client
