// Bundles as files: four bytes "GBB" and the version 1, then the message Bundle.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

inline constexpr char kBundleSuffix[] = ".bundle";

// The bytes of the file. RESOURCE_EXHAUSTED for a bundle that a message cannot hold (2 GB).
absl::StatusOr<std::string> BundleBytes(const v1::Bundle& bundle);

// NOT_FOUND when there is no such file, DATA_LOSS when it is no bundle or not a whole one,
// FAILED_PRECONDITION when it is of a newer version.
absl::StatusOr<v1::Bundle> ReadBundle(const std::filesystem::path& path);

// The bundles that are meant by files and folders: a folder means those in it, the oldest first.
// NOT_FOUND for a path that is not there and for a folder without bundles.
absl::StatusOr<std::vector<std::filesystem::path>> ListBundles(
    const std::vector<std::string>& paths);

}  // namespace graspdb::client
