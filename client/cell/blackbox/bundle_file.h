// Bundle files: four bytes, "GBB" and the version 1, then the message Bundle.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

inline constexpr char kBundleSuffix[] = ".bundle";

// The bytes of the file. RESOURCE_EXHAUSTED for a bundle over the message limit (2 GB).
absl::StatusOr<std::string> BundleBytes(const v1::Bundle& bundle);

// NOT_FOUND when the file does not exist, DATA_LOSS when it is not a bundle, truncated or over 2
// GB, FAILED_PRECONDITION when its version is newer.
absl::StatusOr<v1::Bundle> ReadBundle(const std::filesystem::path& path);

// Expands files and folders: a folder to the bundles in it, the oldest first. NOT_FOUND for a
// missing path and for a folder without bundles.
absl::StatusOr<std::vector<std::filesystem::path>> ListBundles(
    const std::vector<std::string>& paths);

}  // namespace graspdb::client
