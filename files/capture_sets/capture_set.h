// Capture sets: a folder with captures.json beside the clouds.
#pragma once

#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/points/point_file.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::files {

// Name of the description within the folder.
inline constexpr char kCaptureSetFile[] = "captures.json";

// Reads and checks `folder`/captures.json; unknown fields are ignored. The clouds
// are not read.
//
// NOT_FOUND when the file is missing, FAILED_PRECONDITION when it may not be read; INVALID_ARGUMENT
// when it is larger than 256 MiB, not JSON (with line and column), or CheckCaptureSet or
// CheckDistances rejects it.
absl::StatusOr<v1::CaptureSet> LoadCaptureSet(const std::filesystem::path& folder);

// Checks `set` and writes it, indented and atomically, to `folder`/captures.json;
// the folder is created when it is missing. Write the clouds first.
//
// INVALID_ARGUMENT from CheckCaptureSet, otherwise the errors of WriteFileAtomically.
absl::Status SaveCaptureSet(const std::filesystem::path& folder, const v1::CaptureSet& set);

// The captures of `split`, in the order of the file; all without `split`. A capture
// without a split belongs to both, but only one that names its object and stable pose
// can be taught. The pointers are valid as long as `set`.
std::vector<const v1::Capture*> CapturesOf(const v1::CaptureSet& set,
                                           std::optional<v1::Capture::Split> split = std::nullopt);

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
