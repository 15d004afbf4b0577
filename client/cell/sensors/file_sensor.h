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
#include "absl/time/time.h"
#include "client/cell/sensors/depth_sensor.h"
#include "recognition/base/types.h"

namespace graspdb::client {

struct FilePlayback {
  bool loop = false;   // begin again after the last file
  double rate_hz = 0;  // frames a second at most; 0: as often as asked
};

// Gives one file after the other: .pcd and .ply (see point_file.h), and .png with 16-bit depths and
// intrinsics.json beside it (see depth_png.h). A frame's time is that of reading it. Thread-safe.
class FileSensor : public DepthSensor {
 public:
  // `path` is a file, a capture set (its captures in their order, with their sensor poses) or a
  // folder (its files in the order of their names). Nothing of them is read yet.
  //
  // NOT_FOUND when there is no such path, FAILED_PRECONDITION when there is no file to play in it;
  // errors as LoadCaptureSet.
  static absl::StatusOr<std::unique_ptr<FileSensor>> Open(const std::filesystem::path& path,
                                                          const FilePlayback& playback);

  // After the last file UNAVAILABLE. The errors of the readers for a file that cannot be used; the
  // next call goes on with the next file.
  absl::StatusOr<SensorFrame> Next(absl::Time deadline) override ABSL_LOCKS_EXCLUDED(mutex_);
  // Whether there is a file left.
  bool IsReady() override ABSL_LOCKS_EXCLUDED(mutex_);
  bool HasEnded() override { return !IsReady(); }
  std::string Name() const override { return name_; }

 private:
  struct Entry {
    std::filesystem::path path;
    std::optional<recognition::Pose> world_sensor;  // where the capture set says it
  };

  FileSensor(std::string name, std::vector<Entry> entries, const FilePlayback& playback);
  static absl::StatusOr<std::vector<Entry>> List(const std::filesystem::path& path);
  absl::StatusOr<Entry> Take(absl::Time deadline) ABSL_LOCKS_EXCLUDED(mutex_);

  const std::string name_;
  const std::vector<Entry> entries_;
  const FilePlayback playback_;
  absl::Mutex mutex_;
  std::size_t next_ ABSL_GUARDED_BY(mutex_) = 0;
  absl::Time due_ ABSL_GUARDED_BY(mutex_) = absl::InfinitePast();  // of the next frame
};

}  // namespace graspdb::client
