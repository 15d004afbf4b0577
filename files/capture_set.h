// Capture sets: a folder with captures.json beside the clouds.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::client {

// Name of the description within the folder.
inline constexpr char kCaptureSetFile[] = "captures.json";

// Reads and checks `folder`/captures.json; fields that are not known are passed
// over. The clouds themselves are not touched.
//
// NOT_FOUND when the file is missing; INVALID_ARGUMENT when it is no JSON (with
// line and column) or CheckCaptureSet refuses it.
absl::StatusOr<v1::CaptureSet> LoadCaptureSet(const std::filesystem::path& folder);

// Checks `set` and writes it, indented, to `folder`/captures.json, whole or not
// at all; the folder is made when it is missing. Write the clouds first.
//
// INVALID_ARGUMENT from CheckCaptureSet, otherwise the errors of WriteFileAtomically.
absl::Status SaveCaptureSet(const std::filesystem::path& folder, const v1::CaptureSet& set);

// The captures of `split`, in the order of the file, or all without one. A
// capture without a split is for either; but only one that names its object and
// stable pose can be taught. The pointers live as long as `set` does.
std::vector<const v1::Capture*> CapturesOf(const v1::CaptureSet& set,
                                           std::optional<v1::Capture::Split> split = std::nullopt);

}  // namespace graspdb::client
