#include "storage/changes/schema.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "program/base/uuid.h"
#include "storage/base/restore_advice.h"
#include "storage/changes/history_rows.h"
#include "storage/database/family.h"

namespace graspdb::storage {
namespace {

constexpr std::string_view kFormat = "graspdb";

std::string Where(const Database& database) { return "the database at " + database.directory(); }

absl::Status Damaged(const Database& database, std::string_view what) {
  return absl::DataLossError(Where(database) + " is damaged (" + std::string(what) + "); " +
                             std::string(kRestoreAdvice));
}

absl::Status WriteMeta(Database& database, const MetaRecord& meta, rocksdb::WriteBatch& batch) {
  RETURN_IF_ERROR(database.Put(Family::kMeta, kMetaKey, meta.SerializeAsString(), batch));
  return database.Write(batch, WritePurpose::kFree);
}

absl::StatusOr<MetaRecord> Initialize(Database& database, absl::Time now) {
  RETURN_IF_ERROR(database.CreateMissingFamilies());
  MetaRecord meta;
  meta.set_format(std::string(kFormat));
  meta.set_schema_version(kSchemaVersion);
  meta.set_catalog_id(MakeUuid4());
  *meta.mutable_create_time() =
      google::protobuf::util::TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(now));
  rocksdb::WriteBatch batch;
  RETURN_IF_ERROR(WriteMeta(database, meta, batch));
  return meta;
}

absl::Status CheckMigratable(const Database& database, int version,
                             std::span<const Migration> steps, int target) {
  const std::string where =
      Where(database) + " has schema version " + std::to_string(version) + "; this program ";
  if (version > target) {
    return absl::FailedPreconditionError(
        where + "supports up to " + std::to_string(target) +
        "; start the newer program that wrote it, or, with a backup "
        "from before the upgrade, " +
        std::string(kRestoreAdvice));
  }
  for (int from = version; from < target; ++from) {
    const bool known = std::any_of(steps.begin(), steps.end(), [from](const Migration& step) {
      return step.from_version == from;
    });
    if (known) continue;
    return absl::FailedPreconditionError(where +
                                         "cannot migrate it; export the catalogue with the program "
                                         "that wrote it and import it into an empty database");
  }
  return absl::OkStatus();
}

absl::Status CheckRevision(const Database& database, const MetaRecord& meta,
                           std::optional<std::int64_t> floor) {
  if (floor.has_value() && meta.revision() < *floor) {
    return Damaged(database, "changes after revision " + std::to_string(meta.revision()) +
                                 " are lost; the last one was " + std::to_string(*floor));
  }
  ASSIGN_OR_RETURN(const auto key, database.LastKey(Family::kChanges));
  const std::string expected = meta.revision() == 0 ? "" : ChangeKey(meta.revision());
  // They are written together, so they can only differ when one of them was lost.
  if (key != expected) return Damaged(database, "last change record and revision differ");
  if (meta.revision() == 0) return absl::OkStatus();
  ASSIGN_OR_RETURN(const auto oldest,
                   database.Contains(Family::kChanges, ChangeKey(meta.change_horizon() + 1)));
  return oldest ? absl::OkStatus() : Damaged(database, "the oldest change record is missing");
}

// A step to a version that has further families, empty at first. They may exist already, if the
// machine crashed before the version was written. The first `count` families are not created again:
// losing them must be reported.
Migration AddFamiliesAfter(int from_version, std::size_t count) {
  return {from_version, [count](Database& database, rocksdb::WriteBatch& /*batch*/) {
            for (std::size_t i = 0; i < count; ++i) {
              if (database.HasFamily(static_cast<Family>(i))) continue;
              return Damaged(database, "a column family is missing");
            }
            return database.CreateMissingFamilies();
          }};
}

// The history begins with the current revision.
absl::Status BeginHistory(Database& database, rocksdb::WriteBatch& batch) {
  ASSIGN_OR_RETURN(const auto meta, ReadMeta(database));
  HistoryRecord horizon;
  horizon.set_revision(meta.revision());
  return database.Put(Family::kHistory, kHorizonKey, horizon.SerializeAsString(), batch);
}

Migration AddHistory() {
  return {3, [](Database& database, rocksdb::WriteBatch& batch) {
            RETURN_IF_ERROR(AddFamiliesAfter(3, 10).apply(database, batch));
            return BeginHistory(database, batch);
          }};
}

}  // namespace

std::span<const Migration> Migrations() {
  // Version 2: outcomes of grasps. Version 3: bulk uploads. Version 4: deleted objects, history.
  static const std::array<Migration, 3> steps = {AddFamiliesAfter(1, 7), AddFamiliesAfter(2, 8),
                                                 AddHistory()};
  return steps;
}

absl::StatusOr<MetaRecord> ReadMeta(const Database& database, const rocksdb::Snapshot* snapshot) {
  ASSIGN_OR_RETURN(const auto bytes, database.Get(Family::kMeta, kMetaKey, snapshot));
  MetaRecord meta;
  if (!meta.ParseFromString(bytes) || meta.format() != kFormat) {
    return Damaged(database, "its meta record cannot be read");
  }
  return meta;
}

absl::Status Migrate(Database& database, MetaRecord& meta, std::span<const Migration> steps,
                     int target) {
  RETURN_IF_ERROR(CheckMigratable(database, meta.schema_version(), steps, target));
  while (meta.schema_version() < target) {
    const auto step = std::find_if(steps.begin(), steps.end(), [&meta](const Migration& candidate) {
      return candidate.from_version == meta.schema_version();
    });
    rocksdb::WriteBatch batch;
    RETURN_IF_ERROR(step->apply(database, batch));
    MetaRecord next = meta;
    next.set_schema_version(meta.schema_version() + 1);
    RETURN_IF_ERROR(WriteMeta(database, next, batch));
    meta = next;
  }
  return absl::OkStatus();
}

absl::Status RenewCatalogId(Database& database, MetaRecord& meta) {
  MetaRecord next = meta;
  next.set_catalog_id(MakeUuid4());
  rocksdb::WriteBatch batch;
  RETURN_IF_ERROR(WriteMeta(database, next, batch));
  meta = std::move(next);
  return absl::OkStatus();
}

absl::StatusOr<MetaRecord> PrepareSchema(Database& database, std::optional<std::int64_t> floor,
                                         absl::Time now) {
  auto meta = ReadMeta(database);
  if (absl::IsNotFound(meta.status())) {
    // The floor is written after the first MetaRecord.
    if (floor.has_value()) return Damaged(database, "its meta record is lost");
    if (database.IsPristine()) return Initialize(database, now);
    return absl::FailedPreconditionError(
        "the directory " + database.directory() +
        " contains the database of another program; choose an empty "
        "directory or another --db");
  }
  if (!meta.ok()) return meta.status();
  RETURN_IF_ERROR(Migrate(database, *meta, Migrations(), kSchemaVersion));
  if (!database.HasAllFamilies()) return Damaged(database, "a column family is missing");
  RETURN_IF_ERROR(CheckRevision(database, *meta, floor));
  if (meta->catalog_id().empty()) {  // of an earlier program
    RETURN_IF_ERROR(RenewCatalogId(database, *meta));
  }
  return meta;
}

}  // namespace graspdb::storage
