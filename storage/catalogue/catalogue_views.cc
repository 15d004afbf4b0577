// Views and their clouds.
#include <map>
#include <string>

#include "base/status_macros.h"
#include "storage/catalogue/catalogue.h"
#include "storage/changes/change_log.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_list.h"

namespace graspdb::storage {
namespace {

// Digests of the views that the current batch adds; they are not in the database yet.
using AddedDigests = std::map<std::string, std::string>;

absl::Status CheckComplete(const NewView& view) {
  if (!view.record.content_digest().empty() && !view.packed_cloud.empty()) return absl::OkStatus();
  return absl::InvalidArgumentError("the view " + view.record.name() +
                                    " has no digest or no cloud; give both");
}

// kExisting if the digest is stored already, kCreated if the name is free.
absl::StatusOr<PutViewOutcome> CompareWithStored(const Database& database, const ViewRecord& record,
                                                 const AddedDigests& added) {
  std::string stored_digest;
  if (const auto earlier = added.find(record.name()); earlier != added.end()) {
    stored_digest = earlier->second;
  } else {
    const auto stored = ReadRecord<ViewRecord>(database, record.name());
    if (absl::IsNotFound(stored.status())) return PutViewOutcome::kCreated;
    if (!stored.ok()) return stored.status();
    stored_digest = stored->content_digest();
  }
  if (stored_digest == record.content_digest()) return PutViewOutcome::kExisting;
  return absl::AlreadyExistsError("the view " + record.name() +
                                  " exists with other content; delete it first or choose "
                                  "another id");
}

absl::StatusOr<PutViewOutcome> AddView(const Database& database, const NewView& view,
                                       AddedDigests& added, ChangeBatch& batch) {
  const std::string& name = view.record.name();
  ASSIGN_OR_RETURN(const auto parent, Kind<ViewRecord>::ParentOf(name));
  RETURN_IF_ERROR(CheckComplete(view));
  RETURN_IF_ERROR(CheckParent(database, parent));
  auto outcome = CompareWithStored(database, view.record, added);
  if (!outcome.ok() || *outcome == PutViewOutcome::kExisting) return outcome;
  ViewRecord record = view.record;
  const std::int64_t revision = batch.Begin();
  *record.mutable_create_time() = batch.time();
  // An earlier view of that name, which is in the history, has the cloud of that key.
  ASSIGN_OR_RETURN(const auto taken, database.Contains(Family::kClouds, name));
  if (taken) record.set_cloud_key(name + "@" + std::to_string(revision));
  batch.Insert(Family::kViews, name, record.SerializeAsString());
  batch.Insert(Family::kClouds, CloudKeyOf(record), view.packed_cloud);
  added.emplace(name, record.content_digest());
  return outcome;
}

}  // namespace

absl::StatusOr<PutViewOutcome> Catalogue::PutView(const NewView& view) {
  ASSIGN_OR_RETURN(const auto outcomes, PutViews(std::span(&view, 1)));
  return outcomes.front();
}

absl::StatusOr<std::vector<PutViewOutcome>> Catalogue::PutViews(std::span<const NewView> views) {
  std::vector<PutViewOutcome> outcomes;
  const absl::Status stored = log_->Mutate([&](ChangeBatch& batch) -> absl::Status {
    AddedDigests added;
    for (const NewView& view : views) {
      ASSIGN_OR_RETURN(const auto outcome, AddView(*database_, view, added, batch));
      outcomes.push_back(outcome);
    }
    return absl::OkStatus();
  });
  if (!stored.ok()) return stored;
  return outcomes;
}

absl::StatusOr<ViewRecord> Catalogue::GetView(std::string_view name) const {
  return ReadRecord<ViewRecord>(*database_, name);
}

absl::StatusOr<std::string> Catalogue::GetPackedCloud(std::string_view name) const {
  ASSIGN_OR_RETURN(const auto view, GetView(name));
  auto cloud = database_->Get(Family::kClouds, CloudKeyOf(view));
  if (!absl::IsNotFound(cloud.status())) return cloud;
  // Every view has a cloud, but it may have been deleted between the two reads.
  ASSIGN_OR_RETURN(const auto again, GetView(name));
  return again.content_digest() == view.content_digest() ? DamagedRecord(name)
                                                         : GetPackedCloud(name);
}

absl::StatusOr<Page<ViewRecord>> Catalogue::ListViews(std::string_view stable_pose_name,
                                                      std::size_t page_size,
                                                      std::string_view after_name) const {
  RETURN_IF_ERROR(GetStablePose(stable_pose_name).status());
  return ListRecords<ViewRecord>(*database_, stable_pose_name, page_size, after_name);
}

absl::Status Catalogue::DeleteView(std::string_view name) {
  return log_->Mutate(
      [&](ChangeBatch& batch) -> absl::Status {
        ASSIGN_OR_RETURN(const auto record, ReadRecord<ViewRecord>(*database_, name));
        batch.Begin();
        batch.Remove(Family::kViews, name, record.SerializeAsString());
        batch.NoteRemovedCloud(CloudKeyOf(record));
        return absl::OkStatus();
      },
      WritePurpose::kFree);
}

absl::StatusOr<std::int64_t> Catalogue::ReplaceDescriptors(
    std::span<const DescriptorUpdate> updates) {
  std::int64_t revision = 0;
  const absl::Status replaced = log_->Mutate([&](ChangeBatch& batch) -> absl::Status {
    revision = batch.meta().revision();
    for (const DescriptorUpdate& update : updates) {
      auto record = ReadRecord<ViewRecord>(*database_, update.view_name);
      if (absl::IsNotFound(record.status())) continue;
      if (!record.ok()) return record.status();
      if (record->content_digest() != update.content_digest) continue;
      if (batch.changes().empty()) revision = batch.Begin();
      record->mutable_descriptors()->Assign(update.descriptors.begin(), update.descriptors.end());
      batch.Overwrite(Family::kViews, update.view_name, record->SerializeAsString());
    }
    return absl::OkStatus();
  });
  if (!replaced.ok()) return replaced;
  return revision;
}

}  // namespace graspdb::storage
