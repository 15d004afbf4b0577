// Files played as a camera.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/sensors/depth_sensor.h"
#include "program/base/monotonic_time.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct FilePlayback {
  bool loop = false;   // start again after the last file
  double rate_hz = 0;  // maximum frames per second; 0: no limit
};

// Plays files in order, see scan_file.h. A frame's time is when it was read. Thread-safe.
class FileSensor : public DepthSensor {
 public:
  // `path` is a file, a capture set (its captures in order, with their sensor poses) or a folder
  // (its files in order of their names). The files are not read yet.
  //
  // NOT_FOUND when the path does not exist, FAILED_PRECONDITION when it has no file to play; errors
  // as LoadCaptureSet.
  static absl::StatusOr<std::unique_ptr<FileSensor>> Open(const std::filesystem::path& path,
                                                          const FilePlayback& playback);

  // UNAVAILABLE after the last file. The errors of the readers for an invalid file; the next call
  // continues with the next file.
  absl::StatusOr<SensorFrame> Next(MonotonicTime deadline) override ABSL_LOCKS_EXCLUDED(mutex_);
  // Whether a file is left.
  bool IsReady() override ABSL_LOCKS_EXCLUDED(mutex_);
  bool HasEnded() override { return !IsReady(); }
  std::string Name() const override { return name_; }

 private:
  struct Entry {
    std::filesystem::path path;
    std::optional<recognition::Pose> world_sensor;  // from the capture set
  };

  FileSensor(std::string name, std::vector<Entry> entries, const FilePlayback& playback);
  static absl::StatusOr<std::vector<Entry>> List(const std::filesystem::path& path);
  absl::StatusOr<Entry> Take(MonotonicTime deadline) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::string name_;
  const std::vector<Entry> entries_;
  const FilePlayback playback_;
  absl::Mutex mutex_;
  std::size_t next_ ABSL_GUARDED_BY(mutex_) = 0;
  // Of the next frame.
  MonotonicTime due_ ABSL_GUARDED_BY(mutex_) = MonotonicTime::InfinitePast();
};

}  // namespace graspdb::client
