// Writes capture sets that survive a power failure.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "files/points/point_file.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::files {

// Writes the clouds and then the description. Waits for the disk once for each cloud, and at the
// end once for each folder. Not thread-safe.
class CaptureSetWriter {
 public:
  explicit CaptureSetWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}

  // Writes `cloud` to `path` within the folder; missing folders are made. Errors of WritePcd and
  // MakeDurableFolder.
  absl::Status AddCloud(const std::string& path, const PointFile& cloud);

  // Writes captures.json; all that was written is on the disk when it returns, where AtomicFile can
  // do that. Without that, errors of FlushNames and SaveCaptureSet; there may be no captures.json.
  absl::Status Finish(const v1::CaptureSet& set);

 private:
  std::filesystem::path folder_;
  std::set<std::filesystem::path> cloud_folders_;
};

}  // namespace graspdb::files
