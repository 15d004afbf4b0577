// The folder in which a restore works. Internal to storage/.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"

namespace graspdb::storage {

// A folder beside a database that is to be made, on the same disk. A killed restore leaves it; the
// next one to the same database empties it.
class RestoreFolder {
 public:
  // FAILED_PRECONDITION unless `database` is missing or an empty directory, and while another
  // restore to it runs. Makes missing parents.
  static absl::StatusOr<std::unique_ptr<RestoreFolder>> Make(const std::string& database);
  // Removes the folder unless it was published.
  ~RestoreFolder();
  RestoreFolder(const RestoreFolder&) = delete;
  RestoreFolder& operator=(const RestoreFolder&) = delete;

  std::string path() const { return path_.string(); }

  // Renames the folder, whose files are on the disk, to `database`; durable when it returns.
  absl::Status Publish();

 private:
  RestoreFolder(std::filesystem::path database, std::filesystem::path path)
      : database_(std::move(database)), path_(std::move(path)) {}
  absl::Status Lock();

  std::filesystem::path database_;
  std::filesystem::path path_;
  int folder_ = -1;  // its descriptor, locked
};

}  // namespace graspdb::storage
