// Creating and updating the records that have an etag. Internal to storage/.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "base/status_macros.h"
#include "storage/changes/change_log.h"
#include "storage/records/record_kind.h"

namespace graspdb::storage {

// The etag of a record that was last changed in `revision`.
std::string MakeEtag(std::int64_t revision);

// ABORTED when `expected` is given and is not `actual`.
absl::Status CheckEtag(std::string_view name, std::string_view expected, std::string_view actual);

template <typename Record>
absl::StatusOr<Record> CreateRecord(const Database& database, ChangeLog& log, Record record) {
  ASSIGN_OR_RETURN(const auto parent, Kind<Record>::ParentOf(record.name()));
  const absl::Status created = log.Mutate([&](ChangeBatch& batch) -> absl::Status {
    RETURN_IF_ERROR(CheckParent(database, parent));
    ASSIGN_OR_RETURN(const auto taken, database.Contains(Kind<Record>::kFamily, record.name()));
    if (taken) return AlreadyExists(Kind<Record>::kWord, record.name());
    record.set_etag(MakeEtag(batch.Begin()));
    *record.mutable_create_time() = batch.time();
    *record.mutable_update_time() = batch.time();
    batch.Insert(Kind<Record>::kFamily, record.name(), record.SerializeAsString());
    if constexpr (Kind<Record>::kFamily != Family::kObjects) return absl::OkStatus();
    // An earlier object of that name stays in the history of this one.
    return database.Delete(Family::kDeletedObjects, record.name(), batch.rocks());
  });
  if (!created.ok()) return created;
  return record;
}

// Further writes of an update, in the same change.
template <typename Record>
using AlsoChanged =
    std::function<absl::Status(ChangeBatch& batch, const Record& before, const Record& after)>;

template <typename Record>
absl::StatusOr<Record> UpdateRecord(const Database& database, ChangeLog& log, std::string_view name,
                                    std::string_view etag,
                                    const std::function<absl::Status(Record&)>& change,
                                    const AlsoChanged<Record>& also = {}) {
  Record updated;
  const absl::Status status = log.Mutate([&](ChangeBatch& batch) -> absl::Status {
    ASSIGN_OR_RETURN(auto before, ReadRecord<Record>(database, name));
    RETURN_IF_ERROR(CheckEtag(name, etag, before.etag()));
    updated = before;
    RETURN_IF_ERROR(change(updated));
    updated.set_name(std::string(name));
    *updated.mutable_create_time() = before.create_time();
    *updated.mutable_update_time() = batch.time();
    updated.set_etag(MakeEtag(batch.Begin()));
    batch.Replace(Kind<Record>::kFamily, name, before.SerializeAsString(),
                  updated.SerializeAsString(), ChangedFields(before, updated));
    return also ? also(batch, before, updated) : absl::OkStatus();
  });
  if (!status.ok()) return status;
  return updated;
}

// Begins the deletion of a record: NOT_FOUND, ABORTED, or its removal in a new change.
template <typename Record>
absl::Status RemoveRecord(const Database& database, ChangeBatch& batch, std::string_view name,
                          std::string_view etag) {
  ASSIGN_OR_RETURN(const auto record, ReadRecord<Record>(database, name));
  RETURN_IF_ERROR(CheckEtag(name, etag, record.etag()));
  batch.Begin();
  batch.Remove(Kind<Record>::kFamily, name, record.SerializeAsString());
  return absl::OkStatus();
}

}  // namespace graspdb::storage
