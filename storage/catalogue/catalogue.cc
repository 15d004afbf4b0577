#include "storage/catalogue/catalogue.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "base/status_macros.h"
#include "storage/changes/change_log.h"
#include "storage/changes/requests.h"
#include "storage/changes/schema.h"
#include "storage/database/database.h"
#include "storage/database/database_directory.h"
#include "storage/database/revision_floor.h"
#include "storage/history/history.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_list.h"
#include "storage/uploads/uploads.h"

namespace graspdb::storage {
namespace {

// The record of a stable pose, or an empty one.
absl::StatusOr<GraspOutcomesRecord> ReadOutcomes(const Database& database, std::string_view name) {
  auto record = ReadRecord<GraspOutcomesRecord>(database, name);
  if (!absl::IsNotFound(record.status())) return record;
  GraspOutcomesRecord none;
  none.set_name(std::string(name));
  return none;
}

absl::Status CheckAdded(const v1::GraspOutcomeCounts& added) {
  const auto [least, most] =
      std::minmax({added.picked_count(), added.missed_count(), added.slipped_count()});
  if (least >= 0 && most > 0) return absl::OkStatus();
  return absl::InvalidArgumentError("give at least one outcome, and no negative count");
}

absl::Status CheckGrasp(const v1::StablePose& stable_pose, const std::string& grasp_id) {
  const auto is_it = [&](const v1::Grasp& grasp) { return grasp.grasp_id() == grasp_id; };
  if (std::ranges::any_of(stable_pose.grasps(), is_it)) return absl::OkStatus();
  return absl::NotFoundError("the stable pose " + stable_pose.name() + " has no grasp '" +
                             grasp_id + "'; list its grasps");
}

v1::GraspOutcomeCounts& CountsOf(GraspOutcomesRecord& record, const std::string& grasp_id) {
  for (v1::GraspOutcomeCounts& counts : *record.mutable_counts()) {
    if (counts.grasp_id() == grasp_id) return counts;
  }
  v1::GraspOutcomeCounts& added = *record.add_counts();
  added.set_grasp_id(grasp_id);
  return added;
}

// The answer to an earlier request with this id, if any.
absl::StatusOr<std::optional<AddedOutcomes>> FindAdded(const Database& database,
                                                       const RequestKey& request,
                                                       const ChangeBatch& batch) {
  if (request.id.empty()) return std::nullopt;
  ASSIGN_OR_RETURN(const auto found,
                   FindRequest(database, request.id, request.content_digest, batch.time()));
  if (!found.has_value()) return std::nullopt;
  return AddedOutcomes{found->grasp_outcome_counts(), found->revision(), true};
}

void KeepAdded(const AddedOutcomes& added, const RequestKey& request, ChangeBatch& batch) {
  if (request.id.empty()) return;
  RequestRecord record;
  record.set_id(request.id);
  record.set_content_digest(request.content_digest);
  record.set_revision(added.revision);
  *record.mutable_grasp_outcome_counts() = added.counts;
  batch.KeepRequest(std::move(record));
}

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

absl::StatusOr<std::unique_ptr<Catalogue>> Catalogue::Open(const std::string& directory,
                                                           CatalogueOptions options) {
  ASSIGN_OR_RETURN(const auto floor, ReadRevisionFloor(directory));
  ASSIGN_OR_RETURN(auto database,
                   Database::Open(directory, {.create_if_missing = options.create_if_missing,
                                              .write_buffer_bytes = options.write_buffer_bytes,
                                              .env = options.env,
                                              .reserve_bytes = options.disk_reserve_bytes}));
  ASSIGN_OR_RETURN(auto meta, PrepareSchema(*database, floor, options.clock()));
  DeleteOldIndex(directory);
  RETURN_IF_ERROR(WriteRevisionFloor(directory, meta.revision()));
  auto log = std::make_unique<ChangeLog>(*database, std::move(meta),
                                         std::max<std::int64_t>(1, options.keep_changes),
                                         std::move(options.clock));
  // The constructor is private, so std::make_unique cannot call it.
  return std::unique_ptr<Catalogue>(
      new Catalogue(std::move(database), std::move(log), options.max_staged_views));
}

Catalogue::Catalogue(std::unique_ptr<Database> database, std::unique_ptr<ChangeLog> log,
                     std::size_t max_staged_views)
    : database_(std::move(database)),
      log_(std::move(log)),
      uploads_(std::make_unique<Uploads>(*database_, *log_, max_staged_views)),
      history_(std::make_unique<History>(*database_, *log_)) {}

Catalogue::~Catalogue() {
  // An older floor is valid too; it only detects less.
  WriteRevisionFloor(database_->directory(), revision()).IgnoreError();
}

std::string Catalogue::id() const { return log_->meta().catalog_id(); }
std::int64_t Catalogue::revision() const { return log_->meta().revision(); }

CatalogueCounts Catalogue::counts() const {
  const MetaRecord meta = log_->meta();
  return {.objects = meta.object_count(),
          .stable_poses = meta.stable_pose_count(),
          .views = meta.view_count(),
          .cells = meta.cell_count()};
}

int Catalogue::schema_version() const { return log_->meta().schema_version(); }

DatabaseStatus Catalogue::database_status() const { return StatusOf(*database_); }
std::vector<DamagedFile> Catalogue::damaged_files() const { return database_->DamagedFiles(); }
void Catalogue::CheckWrites(std::atomic<bool>* cancelled) { database_->CheckWrites(cancelled); }
const std::string& Catalogue::directory() const { return database_->directory(); }

absl::StatusOr<std::int64_t> Catalogue::ForEach(const RecordVisitor& visitor) const {
  const Database::Snapshot snapshot = database_->TakeSnapshot();
  ASSIGN_OR_RETURN(const auto bytes, database_->Get(Family::kMeta, kMetaKey, snapshot.get()));
  MetaRecord meta;
  if (!meta.ParseFromString(bytes)) return DamagedRecord(kMetaKey);
  RETURN_IF_ERROR(VisitRecords<v1::Object>(*database_, snapshot.get(), visitor.object));
  RETURN_IF_ERROR(VisitRecords<v1::StablePose>(*database_, snapshot.get(), visitor.stable_pose));
  RETURN_IF_ERROR(VisitRecords<ViewRecord>(*database_, snapshot.get(), visitor.view));
  RETURN_IF_ERROR(VisitRecords<v1::Cell>(*database_, snapshot.get(), visitor.cell));
  RETURN_IF_ERROR(
      VisitRecords<GraspOutcomesRecord>(*database_, snapshot.get(), visitor.grasp_outcomes));
  return meta.revision();
}

absl::StatusOr<std::int64_t> Catalogue::Subscribe(ChangeListener listener) {
  return log_->Subscribe(std::move(listener));
}

absl::StatusOr<std::vector<ChangeRecord>> Catalogue::ReadChanges(std::int64_t after_revision,
                                                                 std::size_t limit) const {
  return log_->Read(after_revision, limit);
}

absl::StatusOr<AddedOutcomes> Catalogue::AddGraspOutcomes(std::string_view stable_pose_name,
                                                          const v1::GraspOutcomeCounts& added,
                                                          const RequestKey& request) {
  RETURN_IF_ERROR(CheckAdded(added));
  AddedOutcomes out;
  const absl::Status status = log_->Mutate([&](ChangeBatch& batch) -> absl::Status {
    ASSIGN_OR_RETURN(auto earlier, FindAdded(*database_, request, batch));
    if (earlier.has_value()) {
      out = *std::move(earlier);
      return absl::OkStatus();
    }
    ASSIGN_OR_RETURN(const auto pose, ReadRecord<v1::StablePose>(*database_, stable_pose_name));
    RETURN_IF_ERROR(CheckGrasp(pose, added.grasp_id()));
    ASSIGN_OR_RETURN(auto record, ReadOutcomes(*database_, stable_pose_name));
    v1::GraspOutcomeCounts& counts = CountsOf(record, added.grasp_id());
    counts.set_picked_count(counts.picked_count() + added.picked_count());
    counts.set_missed_count(counts.missed_count() + added.missed_count());
    counts.set_slipped_count(counts.slipped_count() + added.slipped_count());
    out = {counts, batch.Begin()};
    batch.Overwrite(Family::kGraspOutcomes, stable_pose_name, record.SerializeAsString());
    KeepAdded(out, request, batch);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<GraspOutcomesRecord> Catalogue::GetGraspOutcomes(
    std::string_view stable_pose_name) const {
  RETURN_IF_ERROR(GetStablePose(stable_pose_name).status());
  return ReadOutcomes(*database_, stable_pose_name);
}

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
