// Durable names of files and folders.
#pragma once

#include <filesystem>
#include <system_error>

namespace graspdb::storage {

// Returns when what was made, renamed or deleted in `folder` (empty: the current one) is on the
// disk. Does nothing on file systems that cannot do it.
std::error_code SyncFolder(const std::filesystem::path& folder);

// Makes `folder` and the missing ones above it; returns when they are on the disk.
std::error_code MakeFolders(const std::filesystem::path& folder);

}  // namespace graspdb::storage
