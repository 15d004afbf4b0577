// Deletes rows of the history. Internal to storage/.
#pragma once

#include <cstdint>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "rocksdb/write_batch.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

absl::Time TimeOf(const HistoryRecord& row);

// The revision from which on all changes are in the history; 0: all are.
absl::StatusOr<std::int64_t> ReadHorizon(const Database& database);

// While no change is made: adds the deletion of the rows of an object of changes up to
// `last_revision`, and of the clouds that then no row and no view uses.
absl::Status AddPurge(const Database& database, std::string_view object, std::int64_t last_revision,
                      rocksdb::WriteBatch& batch);

// The same for changes that were made before `limit`, as were all before them, with the new
// horizon. Returns whether the object was a deleted one that cannot be undeleted any more.
absl::StatusOr<bool> AddPurgeOlderThan(const Database& database, std::string_view object,
                                       absl::Time limit, rocksdb::WriteBatch& batch);

}  // namespace graspdb::storage
