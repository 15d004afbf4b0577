// Durable names of files and folders.
#pragma once

#include <filesystem>
#include <system_error>

namespace graspdb::storage {

// Whether a folder that may be written but not read, which thus cannot be flushed, is an error:
// permission_denied.
enum class Unreadable { kIsError, kIsAccepted };

// Returns when what was made, renamed or deleted in `folder` (empty: the current one) is on the
// disk. Does nothing on file systems that cannot do it.
std::error_code SyncFolder(const std::filesystem::path& folder,
                           Unreadable unreadable = Unreadable::kIsError);

// Makes `folder` and the missing ones above it; returns when they are on the disk. The lowest that
// exists already is flushed too, for it may be left of a call that was killed; for that one a
// folder above it that cannot be read is no error. After an error none that was made stays, unless
// something was put into it meanwhile. Costs a flush for each folder made, and one.
std::error_code MakeFolders(const std::filesystem::path& folder,
                            Unreadable unreadable = Unreadable::kIsError);

}  // namespace graspdb::storage
