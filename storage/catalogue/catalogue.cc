#include "storage/catalogue/catalogue.h"

#include <algorithm>
#include <utility>

#include "base/status_macros.h"
#include "storage/changes/change_log.h"
#include "storage/changes/schema.h"
#include "storage/database/database.h"
#include "storage/database/database_directory.h"
#include "storage/database/revision_floor.h"
#include "storage/history/history.h"
#include "storage/records/record_list.h"
#include "storage/uploads/uploads.h"

namespace graspdb::storage {

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

}  // namespace graspdb::storage
