// Objects, stable poses and cells.
#include <string>
#include <utility>

#include "base/status_macros.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/change_log.h"
#include "storage/changes/grasp_outcomes.h"
#include "storage/changes/resource_writer.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_list.h"

namespace graspdb::storage {
namespace {

// Removes all records of a family below `prefix` in the current change.
absl::Status RemoveBelow(const Database& database, Family family, const std::string& prefix,
                         ChangeBatch& batch) {
  return database.Scan(family, prefix, "",
                       [&](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
                         batch.Remove(family, key, value);
                         return true;
                       });
}

// Removes all views below `prefix`.
absl::Status RemoveViewsBelow(const Database& database, const std::string& prefix,
                              ChangeBatch& batch) {
  return database.Scan(Family::kViews, prefix, "",
                       [&](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
                         ASSIGN_OR_RETURN(const auto view, ParseRecord<ViewRecord>(key, value));
                         batch.Remove(Family::kViews, key, value);
                         batch.NoteRemovedCloud(CloudKeyOf(view));
                         return true;
                       });
}

absl::StatusOr<bool> IsEmptyBelow(const Database& database, Family family,
                                  const std::string& prefix) {
  bool empty = true;
  const absl::Status scanned = database.Scan(
      family, prefix, "", [&empty](std::string_view, std::string_view) -> absl::StatusOr<bool> {
        empty = false;
        return false;
      });
  if (!scanned.ok()) return scanned;
  return empty;
}

absl::Status CheckChildless(const Database& database, Family family, const std::string& prefix,
                            std::string_view name, std::string_view children) {
  ASSIGN_OR_RETURN(const auto empty, IsEmptyBelow(database, family, prefix));
  if (empty) return absl::OkStatus();
  return absl::FailedPreconditionError(std::string(name) + " has " + std::string(children) +
                                       "; delete them first, or delete with force");
}

// Adds a deleted object to the list of those that can be undeleted.
absl::Status PutDeleted(const Database& database, const v1::Object& object, ChangeBatch& batch) {
  DeletedObjectRecord deleted;
  deleted.set_name(object.name());
  *deleted.mutable_object() = object;
  *deleted.mutable_object()->mutable_delete_time() = batch.time();
  deleted.set_revision(batch.meta().revision());
  return database.Put(Family::kDeletedObjects, object.name(), deleted.SerializeAsString(),
                      batch.rocks());
}

}  // namespace

absl::StatusOr<v1::Object> Catalogue::CreateObject(v1::Object object) {
  object.clear_delete_time();
  object.clear_purge_time();
  return CreateRecord(*database_, *log_, std::move(object));
}

absl::StatusOr<v1::Object> Catalogue::GetObject(std::string_view name) const {
  return ReadRecord<v1::Object>(*database_, name);
}

absl::StatusOr<Page<v1::Object>> Catalogue::ListObjects(std::size_t page_size,
                                                        std::string_view after_name) const {
  return ListRecords<v1::Object>(*database_, "", page_size, after_name);
}

absl::StatusOr<v1::Object> Catalogue::UpdateObject(
    std::string_view name, std::string_view etag,
    const std::function<absl::Status(v1::Object&)>& change) {
  return UpdateRecord(*database_, *log_, name, etag, change);
}

absl::Status Catalogue::DeleteObject(std::string_view name, bool force, std::string_view etag) {
  const std::string below = std::string(name) + std::string(Kind<v1::StablePose>::kCollection);
  return log_->Mutate(
      [&](ChangeBatch& batch) -> absl::Status {
        ASSIGN_OR_RETURN(const auto object, ReadRecord<v1::Object>(*database_, name));
        auto status = RemoveRecord<v1::Object>(*database_, batch, name, etag);
        if (status.ok()) status = PutDeleted(*database_, object, batch);
        if (status.ok() && !force) {
          status = CheckChildless(*database_, Family::kStablePoses, below, name, "stable poses");
        }
        for (const Family family : {Family::kStablePoses, Family::kGraspOutcomes}) {
          if (status.ok() && force) status = RemoveBelow(*database_, family, below, batch);
        }
        return status.ok() && force ? RemoveViewsBelow(*database_, below, batch) : status;
      },
      WritePurpose::kFree);
}

absl::StatusOr<v1::StablePose> Catalogue::CreateStablePose(v1::StablePose stable_pose) {
  stable_pose.clear_grasp_outcomes();  // stored in a record of their own
  return CreateRecord(*database_, *log_, std::move(stable_pose));
}

absl::StatusOr<v1::StablePose> Catalogue::GetStablePose(std::string_view name) const {
  return ReadRecord<v1::StablePose>(*database_, name);
}

absl::StatusOr<Page<v1::StablePose>> Catalogue::ListStablePoses(std::string_view object_name,
                                                                std::size_t page_size,
                                                                std::string_view after_name) const {
  RETURN_IF_ERROR(GetObject(object_name).status());
  return ListRecords<v1::StablePose>(*database_, object_name, page_size, after_name);
}

absl::StatusOr<v1::StablePose> Catalogue::UpdateStablePose(
    std::string_view name, std::string_view etag,
    const std::function<absl::Status(v1::StablePose&)>& change) {
  const auto clean_change = [&change](v1::StablePose& stable_pose) {
    absl::Status status = change(stable_pose);
    stable_pose.clear_grasp_outcomes();
    return status;
  };
  const AlsoChanged<v1::StablePose> also = [this](ChangeBatch& batch, const v1::StablePose& before,
                                                  const v1::StablePose& after) {
    return ForgetChangedGrasps(*database_, batch, before, after);
  };
  return UpdateRecord<v1::StablePose>(*database_, *log_, name, etag, clean_change, also);
}

absl::Status Catalogue::DeleteStablePose(std::string_view name, bool force, std::string_view etag) {
  const std::string below = std::string(name) + std::string(Kind<ViewRecord>::kCollection);
  return log_->Mutate(
      [&](ChangeBatch& batch) -> absl::Status {
        auto status = RemoveRecord<v1::StablePose>(*database_, batch, name, etag);
        if (status.ok() && !force) {
          status = CheckChildless(*database_, Family::kViews, below, name, "views");
        }
        if (status.ok() && force) status = RemoveViewsBelow(*database_, below, batch);
        return status.ok() ? RemoveGraspOutcomes(*database_, batch, name) : status;
      },
      WritePurpose::kFree);
}

absl::StatusOr<v1::Cell> Catalogue::CreateCell(v1::Cell cell) {
  return CreateRecord(*database_, *log_, std::move(cell));
}

absl::StatusOr<v1::Cell> Catalogue::GetCell(std::string_view name) const {
  return ReadRecord<v1::Cell>(*database_, name);
}

absl::StatusOr<Page<v1::Cell>> Catalogue::ListCells(std::size_t page_size,
                                                    std::string_view after_name) const {
  return ListRecords<v1::Cell>(*database_, "", page_size, after_name);
}

absl::StatusOr<v1::Cell> Catalogue::UpdateCell(
    std::string_view name, std::string_view etag,
    const std::function<absl::Status(v1::Cell&)>& change) {
  return UpdateRecord(*database_, *log_, name, etag, change);
}

absl::Status Catalogue::DeleteCell(std::string_view name, std::string_view etag) {
  return log_->Mutate(
      [&](ChangeBatch& batch) { return RemoveRecord<v1::Cell>(*database_, batch, name, etag); },
      WritePurpose::kFree);
}

}  // namespace graspdb::storage
