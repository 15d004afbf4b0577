// The version of the layout on disk, and how older ones are brought up to date.
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
#include "storage/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Version that this program writes. Version 0 never left development: it is refused.
inline constexpr int kSchemaVersion = 2;

// Key of the MetaRecord in the family `default`.
inline constexpr std::string_view kMetaKey = "meta";

// A step from `from_version` to the one after it.
struct Migration {
  int from_version = 0;
  // Adds to `batch` what turns the old layout into the new one. The batch is written
  // together with the new version, so a crash leaves one version or the other. What a
  // migration changes in records it must also change in the change records.
  std::function<absl::Status(Database& database, rocksdb::WriteBatch& batch)> apply;
};

// The steps that this program knows, oldest first.
std::span<const Migration> Migrations();

// Reads the MetaRecord, with a snapshot as it was then. NOT_FOUND when there is none.
absl::StatusOr<MetaRecord> ReadMeta(const Database& database,
                                    const rocksdb::Snapshot* snapshot = nullptr);

// Brings `meta` and the database from their version to `target` through `steps`,
// one batch a step. FAILED_PRECONDITION, with nothing changed, when the version is
// newer than `target` or a step is missing.
absl::Status Migrate(Database& database, MetaRecord& meta, std::span<const Migration> steps,
                     int target);

// Makes the database ready for use and returns its MetaRecord: fills an empty one,
// migrates an older one. `floor` is the revision that it must have reached, if that is
// known. FAILED_PRECONDITION when it is newer, cannot be migrated or is not ours;
// DATA_LOSS when it contradicts itself or `floor`.
absl::StatusOr<MetaRecord> PrepareSchema(Database& database, std::optional<std::int64_t> floor,
                                         absl::Time now);

}  // namespace graspdb::storage
