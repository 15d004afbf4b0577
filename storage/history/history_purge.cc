#include "storage/history/history_purge.h"

#include <map>
#include <string>

#include "absl/functional/function_ref.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "storage/changes/history_rows.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {
namespace {

// Visits all rows of an object, the newest first.
absl::Status VisitRows(
    const Database& database, std::string_view object,
    absl::FunctionRef<absl::StatusOr<bool>(std::string_view key, const HistoryRecord& row)> visit) {
  return database.Scan(Family::kHistory, HistoryPrefix(object), "",
                       [&](std::string_view key, std::string_view bytes) -> absl::StatusOr<bool> {
                         ASSIGN_OR_RETURN(const auto row, ParseRow(key, bytes));
                         return visit(key, row);
                       });
}

// Cloud keys of the views in a row, each with the view's name.
absl::Status AddClouds(const HistoryRecord& row, std::map<std::string, std::string>* clouds) {
  for (const PreviousRecord& previous : row.previous()) {
    if (previous.column_family() != FamilyName(Family::kViews) || !previous.has_value()) continue;
    ASSIGN_OR_RETURN(const auto view, ParseRecord<ViewRecord>(previous.key(), previous.value()));
    clouds->emplace(CloudKeyOf(view), view.name());
  }
  return absl::OkStatus();
}

}  // namespace

absl::Time TimeOf(const HistoryRecord& row) {
  return absl::FromUnixNanos(google::protobuf::util::TimeUtil::TimestampToNanoseconds(row.time()));
}

absl::StatusOr<std::int64_t> ReadHorizon(const Database& database) {
  const auto bytes = database.Get(Family::kHistory, kHorizonKey);
  if (absl::IsNotFound(bytes.status())) return 0;
  if (!bytes.ok()) return bytes.status();
  HistoryRecord horizon;
  if (!horizon.ParseFromString(*bytes)) return DamagedRecord(kHorizonKey);
  return horizon.revision();
}

absl::Status AddPurge(const Database& database, std::string_view object, std::int64_t last_revision,
                      rocksdb::WriteBatch& batch) {
  std::map<std::string, std::string> kept;
  std::map<std::string, std::string> unused;
  const auto add = [&](std::string_view key, const HistoryRecord& row) -> absl::StatusOr<bool> {
    const bool goes = row.revision() <= last_revision;
    absl::Status status = AddClouds(row, goes ? &unused : &kept);
    if (goes) status.Update(database.Delete(Family::kHistory, key, batch));
    if (!status.ok()) return status;
    return true;
  };
  RETURN_IF_ERROR(VisitRows(database, object, add));
  for (const auto& [cloud, view_name] : unused) {
    if (kept.contains(cloud)) continue;
    const auto view = ReadRecord<ViewRecord>(database, view_name);
    if (!view.ok() && !absl::IsNotFound(view.status())) return view.status();
    if (view.ok() && CloudKeyOf(*view) == cloud) continue;
    RETURN_IF_ERROR(database.Delete(Family::kClouds, cloud, batch));
  }
  return absl::OkStatus();
}

absl::StatusOr<bool> AddPurgeOlderThan(const Database& database, std::string_view object,
                                       absl::Time limit, rocksdb::WriteBatch& batch) {
  std::int64_t last = 0;
  // The newest first. A change of a time when the clock was wrong goes with those before it.
  const auto find = [&](std::string_view, const HistoryRecord& row) -> absl::StatusOr<bool> {
    if (TimeOf(row) >= limit) {
      last = 0;
    } else if (last == 0) {
      last = row.revision();
    }
    return true;
  };
  absl::Status status = VisitRows(database, object, find);
  if (status.ok()) status = AddPurge(database, object, last, batch);
  const auto horizon = ReadHorizon(database);
  status.Update(horizon.status());
  if (!status.ok()) return status;
  if (last > *horizon) {
    HistoryRecord moved;
    moved.set_revision(last);
    status = database.Put(Family::kHistory, kHorizonKey, moved.SerializeAsString(), batch);
  }
  const auto deleted = ReadRecord<DeletedObjectRecord>(database, object);
  if (!deleted.ok() && !absl::IsNotFound(deleted.status())) return deleted.status();
  const bool gone = deleted.ok() && deleted->revision() <= last;
  if (gone) status.Update(database.Delete(Family::kDeletedObjects, object, batch));
  if (!status.ok()) return status;
  return gone;
}

}  // namespace graspdb::storage
