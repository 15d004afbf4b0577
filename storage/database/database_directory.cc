#include "storage/database/database_directory.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>

#include "absl/status/status.h"
#include "storage/base/folder_sync.h"
#include "storage/base/restore_advice.h"
#include "storage/database/revision_floor.h"

namespace graspdb::storage {
namespace {

// Files that RocksDB writes before CURRENT, which marks a database, and those of a new
// file system.
bool MayPrecedeDatabase(std::string_view name) {
  constexpr std::array<std::string_view, 5> kNames = {"LOCK", "IDENTITY", "LOG", "lost+found",
                                                      "LOG.old"};
  constexpr std::array<std::string_view, 4> kPrefixes = {"MANIFEST-", "OPTIONS-", "LOG.old.",
                                                         "CURRENT."};
  return std::find(kNames.begin(), kNames.end(), name) != kNames.end() ||
         name.ends_with(".dbtmp") ||
         std::any_of(kPrefixes.begin(), kPrefixes.end(),
                     [name](std::string_view prefix) { return name.starts_with(prefix); });
}

absl::Status CannotRead(const std::string& directory, const std::error_code& error) {
  return absl::UnavailableError("the directory " + directory + " cannot be read (" +
                                error.message() +
                                "); check its permissions or choose another --db");
}

}  // namespace

absl::StatusOr<DirectoryContent> InspectDirectory(const std::string& directory) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(directory, error);
  if (status.type() == std::filesystem::file_type::not_found) return DirectoryContent::kNothing;
  if (error) return CannotRead(directory, error);
  if (status.type() != std::filesystem::file_type::directory) {
    return absl::FailedPreconditionError(directory + " is not a directory; choose another --db");
  }
  bool foreign = false;
  bool ours = false;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name == "CURRENT") return DirectoryContent::kDatabase;
    ours |= name == kRevisionFloorFile;
    foreign |= !MayPrecedeDatabase(name);
  }
  if (error) return CannotRead(directory, error);
  if (ours) {
    return absl::DataLossError("the database at " + directory +
                               " is damaged (the file CURRENT is missing); " +
                               std::string(kRestoreAdvice));
  }
  if (!foreign) return DirectoryContent::kNothing;
  return absl::FailedPreconditionError("the directory " + directory +
                                       " is not empty and is not a graspdb database; choose an "
                                       "empty directory or another --db");
}

void DeleteOldIndex(const std::string& directory) {
  for (const char* name : {"/INDEX", "/INDEX.dbtmp", "/INDEX.flann", "/INDEX.flann.dbtmp"}) {
    // One that cannot be deleted only takes space.
    std::error_code ignored;
    std::filesystem::remove(directory + name, ignored);
  }
}

absl::Status MakeDirectory(const std::string& directory) {
  const std::error_code error = MakeFolders(directory);
  if (!error) return absl::OkStatus();
  return absl::UnavailableError("the directory " + directory + " cannot be created (" +
                                error.message() +
                                "); check its permissions or choose another --db");
}

}  // namespace graspdb::storage
