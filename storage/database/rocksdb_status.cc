#include "storage/database/rocksdb_status.h"

#include <string>

#include "storage/base/restore_advice.h"

namespace graspdb::storage {

absl::Status FromRocksDb(const rocksdb::Status& status, std::string_view action) {
  if (status.ok()) return absl::OkStatus();
  const std::string what = "cannot " + std::string(action) + ": " + status.ToString();
  if (status.IsNotFound()) return absl::NotFoundError(what);
  if (status.IsCorruption() || status.IsPathNotFound()) {  // a file that was deleted
    return absl::DataLossError(what + "; " + std::string(kRestoreAdvice));
  }
  if (status.IsNoSpace()) {
    return absl::ResourceExhaustedError(what + "; free space on the disk, and repeat the call");
  }
  return absl::UnavailableError(what + "; check the disk and restart the server");
}

absl::Status FromRocksDbWrite(const rocksdb::Status& status) {
  if (!status.IsIOError() || status.IsNoSpace()) return FromRocksDb(status, "write the change");
  return absl::UnavailableError("cannot write the change: " + status.ToString() +
                                "; check the disk: the server tries again by itself, at least "
                                "every 30 s; if that does not help, restart it");
}

bool IsLockTaken(const rocksdb::Status& status) {
  // RocksDB has no error code for it; both of its texts (lock of this process, lock of another one)
  // have the word, and no other error of opening does.
  const std::string text = status.ToString();
  return status.IsIOError() && (text.find("lock hold by current process") != std::string::npos ||
                                text.find("While lock file") != std::string::npos);
}

absl::Status FromRocksDbOpen(const rocksdb::Status& status, std::string_view directory) {
  if (status.ok()) return absl::OkStatus();
  const std::string where = "the database at " + std::string(directory);
  if (IsLockTaken(status)) {
    return absl::FailedPreconditionError(
        where + " is in use by another process; stop it or choose another --db");
  }
  const bool file_missing = status.IsNotFound() || status.IsPathNotFound();
  if (status.IsCorruption() || file_missing) {
    return absl::DataLossError(where + " is damaged (" + status.ToString() + "); " +
                               std::string(kRestoreAdvice));
  }
  if (status.IsInvalidArgument() || status.IsNotSupported()) {
    return absl::FailedPreconditionError(where + " was not created by this program (" +
                                         status.ToString() + "); choose another --db");
  }
  if (status.IsNoSpace()) {
    return absl::ResourceExhaustedError(where + " cannot be opened (" + status.ToString() +
                                        "); free space on the disk");
  }
  return absl::UnavailableError(where + " cannot be opened (" + status.ToString() +
                                "); check the disk and the permissions of the directory");
}

}  // namespace graspdb::storage
