#include "storage/history/history.h"

#include <algorithm>
#include <limits>

#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "rocksdb/iterator.h"
#include "storage/changes/change_log.h"
#include "storage/changes/history_rows.h"
#include "storage/changes/resource_writer.h"
#include "storage/database/rocksdb_status.h"
#include "storage/history/history_purge.h"
#include "storage/history/object_restorer.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_list.h"

namespace graspdb::storage {
namespace {

constexpr std::int64_t kFirstRevision = 1;
constexpr std::uint32_t kLastPart = std::numeric_limits<std::uint32_t>::max();

// The first part of the next change of the object after the key `after`; nothing at the end.
absl::StatusOr<std::optional<HistoryRecord>> NextRow(const Database& database,
                                                     std::string_view object,
                                                     const std::string& after) {
  std::optional<HistoryRecord> out;
  const absl::Status scanned =
      database.Scan(Family::kHistory, HistoryPrefix(object), after,
                    [&](std::string_view key, std::string_view bytes) -> absl::StatusOr<bool> {
                      ASSIGN_OR_RETURN(out, ParseRow(key, bytes));
                      return false;
                    });
  if (!scanned.ok()) return scanned;
  return out;
}

// Objects with a change before `limit`, by the last row of each, which is the oldest.
absl::StatusOr<std::vector<std::string>> ObjectsOlderThan(const Database& database,
                                                          absl::Time limit) {
  std::vector<std::string> out;
  const auto rows = database.Rows(Family::kHistory, nullptr);
  for (rows->SeekToLast(); rows->Valid();) {
    const std::string key = rows->key().ToString();
    if (key == kHorizonKey) break;
    ASSIGN_OR_RETURN(const auto row, ParseRow(key, rows->value().ToString()));
    if (TimeOf(row) < limit) out.emplace_back(ObjectOf(key));
    rows->SeekForPrev(HistoryPrefix(ObjectOf(key)));
  }
  if (!rows->status().ok()) return FromRocksDb(rows->status(), "read the history");
  return out;
}

}  // namespace

absl::StatusOr<Page<DeletedObjectRecord>> History::ListDeleted(std::size_t page_size,
                                                               std::string_view after_name) const {
  return ListRecords<DeletedObjectRecord>(database_, "", page_size, after_name);
}

absl::StatusOr<DeletedObjectRecord> History::GetDeleted(std::string_view name) const {
  return ReadRecord<DeletedObjectRecord>(database_, name);
}

absl::StatusOr<Page<HistoryRecord>> History::List(std::string_view object_name,
                                                  std::size_t page_size,
                                                  std::int64_t before_revision) const {
  RETURN_IF_ERROR(Kind<v1::Object>::ParentOf(object_name).status());
  Page<HistoryRecord> page;
  std::string after =
      before_revision == 0 ? "" : HistoryKey(object_name, before_revision, kLastPart);
  for (std::size_t bytes = 0;;) {
    ASSIGN_OR_RETURN(auto row, NextRow(database_, object_name, after));
    if (!row) break;
    bytes += row->ByteSizeLong();
    if (EndsPage(page_size, bytes, &page)) break;
    after = HistoryKey(object_name, row->revision(), kLastPart);
    page.records.push_back(*std::move(row));
  }
  if (!page.records.empty() || before_revision != 0) return page;
  // An object of before the history has no rows.
  RETURN_IF_ERROR(ReadRecord<v1::Object>(database_, object_name).status());
  return page;
}

absl::StatusOr<v1::Object> History::RestoreIn(std::string_view name, std::int64_t revision,
                                              ChangeBatch& batch) {
  RETURN_IF_ERROR(ObjectRestorer(database_, batch).Restore(name, revision));
  RETURN_IF_ERROR(database_.Delete(Family::kDeletedObjects, name, batch.rocks()));
  if (!batch.changes().empty()) {
    for (const Mutation& mutation : batch.changes().back().mutations()) {
      if (mutation.column_family() != FamilyName(Family::kObjects)) continue;
      return ParseRecord<v1::Object>(name, mutation.value());
    }
  }
  return ReadRecord<v1::Object>(database_, name);
}

absl::StatusOr<v1::Object> History::Undelete(std::string_view name) {
  absl::StatusOr<v1::Object> object;
  const absl::Status status = log_.Mutate([&](ChangeBatch& batch) -> absl::Status {
    ASSIGN_OR_RETURN(const auto deleted, GetDeleted(name));
    object = RestoreIn(name, deleted.revision() - 1, batch);
    return object.status();
  });
  if (!status.ok()) return status;
  return object;
}

absl::StatusOr<v1::Object> History::Restore(std::string_view name, std::int64_t revision,
                                            std::string_view etag) {
  RETURN_IF_ERROR(Kind<v1::Object>::ParentOf(name).status());
  absl::StatusOr<v1::Object> object;
  const absl::Status status = log_.Mutate([&](ChangeBatch& batch) -> absl::Status {
    ASSIGN_OR_RETURN(const auto horizon, ReadHorizon(database_));
    if (revision < horizon || revision > batch.meta().revision()) {
      // After revision 0 there was no object.
      return absl::OutOfRangeError(
          "revisions " + std::to_string(std::max(horizon, kFirstRevision)) + " to " +
          std::to_string(batch.meta().revision()) + " are kept; choose one of them");
    }
    const auto now = ReadRecord<v1::Object>(database_, name);
    if (!now.ok() && !absl::IsNotFound(now.status())) return now.status();
    RETURN_IF_ERROR(CheckEtag(name, etag, now.ok() ? now->etag() : ""));
    object = RestoreIn(name, revision, batch);
    return object.status();
  });
  if (!status.ok()) return status;
  return object;
}

absl::Status History::Purge(std::string_view name) {
  database_.PrepareToFree(0);
  return log_.PauseChanges([&](const MetaRecord&, absl::FunctionRef<void()>) -> absl::Status {
    ASSIGN_OR_RETURN(const auto deleted, GetDeleted(name));
    rocksdb::WriteBatch batch;
    RETURN_IF_ERROR(AddPurge(database_, name, deleted.revision(), batch));
    RETURN_IF_ERROR(database_.Delete(Family::kDeletedObjects, name, batch));
    return database_.Write(batch, WritePurpose::kFree);
  });
}

absl::StatusOr<std::vector<std::string>> History::PurgeOlderThan(absl::Time limit) {
  ASSIGN_OR_RETURN(const auto objects, ObjectsOlderThan(database_, limit));
  std::vector<std::string> purged;
  if (!objects.empty()) database_.PrepareToFree(0);
  for (const std::string& name : objects) {
    // One after the other: writers wait for one object.
    const absl::Status status =
        log_.PauseChanges([&](const MetaRecord&, absl::FunctionRef<void()>) -> absl::Status {
          rocksdb::WriteBatch batch;
          ASSIGN_OR_RETURN(const auto gone, AddPurgeOlderThan(database_, name, limit, batch));
          absl::Status written = database_.Write(batch, WritePurpose::kFree);
          if (written.ok() && gone) purged.push_back(name);
          return written;
        });
    if (!status.ok()) return status;
  }
  return purged;
}

}  // namespace graspdb::storage
