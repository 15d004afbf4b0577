// Comparison of two databases by the names of their records. Internal to storage/.
#pragma once

#include "absl/status/status.h"
#include "rocksdb/snapshot.h"
#include "storage/backups/backups.h"
#include "storage/database/database.h"

namespace graspdb::storage {

// One state of a database; without a snapshot, of one that does not change.
struct DatabaseState {
  const Database& database;
  const rocksdb::Snapshot* snapshot = nullptr;
};

// Visits what changes between two states: objects, then stable poses, views and cells, each by
// name. Reads the rows of both once, in their order. CANCELLED, or the error of `visit`.
absl::Status FindDifferences(const DatabaseState& before, const DatabaseState& after,
                             const BackupProgress& progress, DifferenceVisitor visit);

}  // namespace graspdb::storage
