// Converts RocksDB's errors to ours.
#pragma once

#include <string_view>

#include "absl/status/status.h"
#include "rocksdb/status.h"

namespace graspdb::storage {

// The status of an operation on an open database. `action` describes it, e.g. "write
// the change". Corruption or a missing file is DATA_LOSS, a full disk RESOURCE_EXHAUSTED,
// a missing key NOT_FOUND, anything else UNAVAILABLE.
absl::Status FromRocksDb(const rocksdb::Status& status, std::string_view action);

// The status of a failed write of an open database: as above, but for the advice, since writes are
// tried again (Database::Recover()).
absl::Status FromRocksDbWrite(const rocksdb::Status& status);

// Whether opening failed since this process or another one holds the lock file.
bool IsLockTaken(const rocksdb::Status& status);

// The status of opening the database in `directory`. A second owner is
// FAILED_PRECONDITION, a missing or damaged file DATA_LOSS.
absl::Status FromRocksDbOpen(const rocksdb::Status& status, std::string_view directory);

}  // namespace graspdb::storage
