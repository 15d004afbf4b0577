// The version of the layout on disk, and migrations from older ones.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "rocksdb/write_batch.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Version that this program writes. Version 0 was never released: it is rejected.
inline constexpr int kSchemaVersion = 4;

// Key of the MetaRecord in the family `default`.
inline constexpr std::string_view kMetaKey = "meta";

// A step from `from_version` to the one after it.
struct Migration {
  int from_version = 0;
  // Adds the changes from the old layout to the new one to `batch`. The batch is written
  // together with the new version, so a crash leaves one version or the other. Changes
  // to records must be made in the change records too.
  std::function<absl::Status(Database& database, rocksdb::WriteBatch& batch)> apply;
};

// The steps that this program knows, oldest first.
std::span<const Migration> Migrations();

// Reads the MetaRecord, optionally of a snapshot. NOT_FOUND when there is none.
absl::StatusOr<MetaRecord> ReadMeta(const Database& database,
                                    const rocksdb::Snapshot* snapshot = nullptr);

// Migrates `meta` and the database from their version to `target` through `steps`,
// one batch per step. FAILED_PRECONDITION, with nothing changed, when the version is
// newer than `target` or a step is missing.
absl::Status Migrate(Database& database, MetaRecord& meta, std::span<const Migration> steps,
                     int target);

// Writes a new id of the catalogue, and nothing else.
absl::Status RenewCatalogId(Database& database, MetaRecord& meta);

// Prepares the database for use and returns its MetaRecord: initialises an empty one,
// migrates an older one, and gives it an id if it has none. `floor` is the minimum revision that it
// must have, if known. FAILED_PRECONDITION when it is newer, cannot be migrated or is of another
// program; DATA_LOSS when it is inconsistent or below `floor`.
absl::StatusOr<MetaRecord> PrepareSchema(Database& database, std::optional<std::int64_t> floor,
                                         absl::Time now);

}  // namespace graspdb::storage
