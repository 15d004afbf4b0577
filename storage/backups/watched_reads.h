// Progress and cancellation of RocksDB's functions that have neither. Internal to storage/.
#pragma once

#include <memory>

#include "rocksdb/env.h"
#include "storage/backups/backups.h"

namespace graspdb::storage {

// The machine's files. Files that are read from their beginning to their end are counted in
// `progress`, which must outlive the result, and fail with IOError once it is cancelled.
std::unique_ptr<rocksdb::Env> WatchReads(const BackupProgress& progress);

}  // namespace graspdb::storage
