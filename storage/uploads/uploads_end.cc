// The end of an upload: its views become part of the catalogue, or are deleted.
#include <utility>

#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "storage/changes/change_log.h"
#include "storage/database/database.h"
#include "storage/records/record_list.h"
#include "storage/uploads/open_upload.h"
#include "storage/uploads/upload_commit.h"
#include "storage/uploads/uploads.h"

namespace graspdb::storage {

absl::StatusOr<UploadRecord> Uploads::GetAgain(const UploadRecord& upload) const {
  auto record = Get(upload.name());
  if (record.ok() && record->staging_prefix() != upload.staging_prefix()) {
    return DeletedUpload(upload.name());
  }
  return record;
}

absl::StatusOr<UploadRecord> Uploads::Commit(const UploadRecord& upload, bool skip_failed,
                                             const std::function<bool()>& is_cancelled) {
  auto record = GetAgain(upload);
  if (!record.ok() || record->has_commit_time()) return record;
  const auto open = OpenOf(upload);
  // Another call has committed it.
  if (absl::IsFailedPrecondition(open.status())) return GetAgain(upload);
  if (!open.ok()) return open.status();
  absl::MutexLock use(&(*open)->in_use);
  record = GetAgain(upload);
  if (!record.ok() || record->has_commit_time()) return record;
  if (!(*open)->end.ok()) return (*open)->end;
  const absl::Status committed = log_.Mutate([&](ChangeBatch& batch) {
    absl::Status added = AddCommit(database_, skip_failed, is_cancelled, &*record, batch);
    // Without a change of the catalogue the batch is not written by the log.
    return added.ok() && batch.changes().empty() ? database_.Write(batch.rocks()) : added;
  });
  if (!committed.ok()) return committed;
  End(upload.name(), **open, CommittedUpload(upload.name()));
  return record;
}

absl::Status Uploads::Delete(std::string_view name) {
  ASSIGN_OR_RETURN(auto record, Get(name));
  OpenUpload open;
  if (!record.has_commit_time()) {
    ASSIGN_OR_RETURN(open, OpenOf(name));
  }
  rocksdb::WriteBatch batch;
  absl::Status status = database_.Delete(Family::kUploads, name, batch);
  if (open == nullptr) return status.ok() ? database_.Write(batch, WritePurpose::kFree) : status;
  absl::MutexLock use(&open->in_use);
  if (!open->end.ok()) {
    return absl::AbortedError(std::string(name) + " was committed or deleted meanwhile");
  }
  const std::string prefix = StagedKey(open->record, "");
  for (const Family family : {Family::kStagedViews, Family::kClouds}) {
    status.Update(database_.DeletePrefix(family, prefix, batch));
  }
  if (status.ok()) status = database_.Write(batch, WritePurpose::kFree);
  if (status.ok()) End(name, *open, DeletedUpload(name));
  return status;
}

void Uploads::End(std::string_view name, Open& open, absl::Status why) {
  open.end = std::move(why);
  absl::MutexLock lock(&mutex_);
  open_.erase(std::string(name));
  absl::MutexLock names(&open.names);
  staged_views_ -= open.views.size();
}

absl::StatusOr<std::vector<std::string>> Uploads::DeleteOlderThan(absl::Time open_limit,
                                                                  absl::Time committed_limit) {
  std::vector<UploadRecord> old;
  const absl::Status status =
      VisitRecords<UploadRecord>(database_, nullptr, [&](const UploadRecord& upload) {
        const bool is_committed = upload.has_commit_time();
        const absl::Time begin =
            absl::FromUnixNanos(google::protobuf::util::TimeUtil::TimestampToNanoseconds(
                is_committed ? upload.commit_time() : upload.create_time()));
        if (begin < (is_committed ? committed_limit : open_limit)) {
          old.push_back(upload);
        }
        return absl::OkStatus();
      });
  if (!status.ok()) return status;
  std::vector<std::string> abandoned;
  for (const UploadRecord& upload : old) {
    RETURN_IF_ERROR(Delete(upload.name()));
    if (!upload.has_commit_time()) abandoned.push_back(upload.name());
  }
  return abandoned;
}

}  // namespace graspdb::storage
