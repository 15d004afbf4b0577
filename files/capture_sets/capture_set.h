// Capture sets: a folder with captures.json beside the clouds.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::files {

// Name of the description within the folder.
inline constexpr char kCaptureSetFile[] = "captures.json";

// Reads and checks `folder`/captures.json; unknown fields are ignored. The clouds
// are not read.
//
// NOT_FOUND when the file is missing or may not be read; INVALID_ARGUMENT when it is not JSON (with
// line and column), or CheckCaptureSet or CheckDistances rejects it.
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

}  // namespace graspdb::files
