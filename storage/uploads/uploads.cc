#include "storage/uploads/uploads.h"

#include <random>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "storage/changes/change_log.h"
#include "storage/database/database.h"
#include "storage/records/record_kind.h"
#include "storage/records/record_list.h"
#include "storage/uploads/open_upload.h"
#include "storage/uploads/upload_commit.h"

namespace graspdb::storage {
namespace {

using google::protobuf::util::TimeUtil;

}  // namespace

absl::Status CommittedUpload(std::string_view name) {
  return absl::FailedPreconditionError(
      absl::StrCat(std::string(name), " is committed already; create another upload"));
}

absl::Status DeletedUpload(std::string_view name) {
  return absl::AbortedError(absl::StrCat(
      std::string(name), " was deleted meanwhile; create an upload and send all views to it"));
}

absl::StatusOr<UploadRecord> Uploads::Create(const UploadRecord& wanted, absl::Time now) {
  RETURN_IF_ERROR(Kind<UploadRecord>::ParentOf(wanted.name()).status());
  absl::MutexLock lock(&mutex_);
  ASSIGN_OR_RETURN(const auto taken, database_.Contains(Family::kUploads, wanted.name()));
  if (taken) return AlreadyExists(Kind<UploadRecord>::kWord, wanted.name());
  std::size_t open = 0;
  const absl::Status counted =
      VisitRecords<UploadRecord>(database_, nullptr, [&](const UploadRecord& other) {
        if (!other.has_commit_time()) ++open;
        return absl::OkStatus();
      });
  if (!counted.ok()) return counted;
  if (open >= kMaxOpenUploads) {
    return absl::ResourceExhaustedError(
        absl::StrCat(open, " uploads are open; commit or delete some of them first"));
  }
  UploadRecord record;
  record.set_name(wanted.name());
  record.set_replace(wanted.replace());
  record.set_expected_view_count(wanted.expected_view_count());
  *record.mutable_create_time() = TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(now));
  // Random, since a name may be used again while the clouds of its first upload are in use.
  std::random_device random;
  const auto number = (static_cast<std::uint64_t>(random()) << 32U) | random();
  record.set_staging_prefix(absl::StrCat("uploads/", absl::Hex(number, absl::kZeroPad16)));
  rocksdb::WriteBatch batch;
  RETURN_IF_ERROR(
      database_.Put(Family::kUploads, record.name(), record.SerializeAsString(), batch));
  RETURN_IF_ERROR(database_.Write(batch));
  return record;
}

absl::StatusOr<UploadRecord> Uploads::Get(std::string_view name) const {
  return ReadRecord<UploadRecord>(database_, name);
}

absl::StatusOr<Page<UploadRecord>> Uploads::List(std::size_t page_size,
                                                 std::string_view after_name) const {
  return ListRecords<UploadRecord>(database_, "", page_size, after_name);
}

absl::StatusOr<StagedCounts> Uploads::CountsOf(const UploadRecord& upload) {
  if (upload.has_commit_time()) return StagedCounts();
  const auto open = OpenOf(upload.name());
  // Committed meanwhile.
  if (absl::IsFailedPrecondition(open.status())) return StagedCounts();
  if (!open.ok()) return open.status();
  absl::MutexLock lock(&(*open)->names);
  return (*open)->stored;
}

absl::StatusOr<Page<StagedItem>> Uploads::ListItems(const UploadRecord& upload,
                                                    std::size_t page_size,
                                                    std::string_view after_name) const {
  RETURN_IF_ERROR(CheckPage(page_size, "", after_name));
  Page<StagedItem> page;
  std::size_t bytes = 0;
  const auto add = [&](const std::string& name,
                       const StagedViewRecord& staged) -> absl::StatusOr<bool> {
    bytes += name.size() + staged.error().message().size();
    if (EndsPage(page_size, bytes, &page)) return false;
    page.records.push_back({name, absl::Status(static_cast<absl::StatusCode>(staged.error().code()),
                                               staged.error().message())});
    return true;
  };
  RETURN_IF_ERROR(VisitStaged(database_, upload, after_name, add));
  return page;
}

absl::StatusOr<Uploads::OpenUpload> Uploads::OpenOf(std::string_view name) {
  absl::MutexLock lock(&mutex_);
  if (const auto found = open_.find(name); found != open_.end()) return found->second;
  ASSIGN_OR_RETURN(auto record, Get(name));
  if (record.has_commit_time()) return CommittedUpload(name);
  auto open = std::make_shared<Open>();
  open->record = std::move(record);
  absl::MutexLock names_lock(&open->names);
  const auto add = [&](const std::string& view_name,
                       const StagedViewRecord& staged) -> absl::StatusOr<bool> {
    ++(staged.has_error() ? open->stored.errors : open->stored.views);
    open->views[view_name] = {staged.view().content_digest(), true};
    return true;
  };
  RETURN_IF_ERROR(VisitStaged(database_, open->record, "", add));
  staged_views_ += open->views.size();
  return open_.emplace(name, std::move(open)).first->second;
}

absl::StatusOr<Uploads::OpenUpload> Uploads::OpenOf(const UploadRecord& upload) {
  auto open = OpenOf(upload.name());
  if (open.ok() && (*open)->record.staging_prefix() != upload.staging_prefix()) {
    return DeletedUpload(upload.name());
  }
  return open;
}

absl::Status Uploads::CountAll() {
  if (all_counted_) return absl::OkStatus();
  std::vector<std::string> names;
  absl::Status visited =
      VisitRecords<UploadRecord>(database_, nullptr, [&](const UploadRecord& upload) {
        if (!upload.has_commit_time()) names.push_back(upload.name());
        return absl::OkStatus();
      });
  if (!visited.ok()) return visited;
  // One that is damaged stops those only who use it.
  for (const std::string& name : names) OpenOf(name).status().IgnoreError();
  all_counted_ = true;
  return absl::OkStatus();
}

absl::Status Uploads::CountNew(const Open& open) {
  if (open.views.size() >= kMaxStagedViews) {
    return absl::ResourceExhaustedError(absl::StrCat("the upload has ", kMaxStagedViews,
                                                     " views, the most that it can have; "
                                                     "commit it and create another one"));
  }
  if (staged_views_.fetch_add(1) < max_staged_views_) return absl::OkStatus();
  --staged_views_;
  return absl::ResourceExhaustedError(
      absl::StrCat("the open uploads have ", max_staged_views_,
                   " views, the most that they can have together; commit or delete one of them"));
}

absl::StatusOr<UploadRecord> Uploads::GetOpen(std::string_view name) {
  ASSIGN_OR_RETURN(const auto open, OpenOf(name));
  return open->record;
}

absl::StatusOr<PutViewOutcome> Uploads::Stage(const UploadRecord& upload, const NewView& view) {
  const std::string& name = view.record.name();
  ASSIGN_OR_RETURN(const auto parent, Kind<ViewRecord>::ParentOf(name));
  if (view.record.content_digest().empty() || view.packed_cloud.empty()) {
    return absl::InvalidArgumentError(name + " has no digest or no cloud; give both");
  }
  RETURN_IF_ERROR(CountAll());
  ASSIGN_OR_RETURN(const auto found, OpenOf(upload));
  Open& open = *found;
  absl::ReaderMutexLock use(&open.in_use);
  if (!open.end.ok()) return open.end;
  {
    absl::MutexLock lock(&open.names);
    open.AwaitStored(name);
    const Open::View* known = open.Find(name);
    if (known != nullptr && !known->digest.empty()) {
      if (known->digest == view.record.content_digest()) return PutViewOutcome::kExisting;
      return absl::AlreadyExistsError(name +
                                      " was sent with other content in this upload; choose another "
                                      "id");
    }
    if (known == nullptr) {
      RETURN_IF_ERROR(CountNew(open));
    } else {
      --open.stored.errors;
    }
    open.views[name] = {view.record.content_digest(), false};
  }
  StagedViewRecord staged;
  *staged.mutable_view() = view.record;
  const auto pose = ReadRecord<v1::StablePose>(database_, parent.name);
  if (pose.ok()) *staged.mutable_stable_pose_create_time() = pose->create_time();
  RETURN_IF_ERROR(Write(open, name, staged, &view.packed_cloud));
  return PutViewOutcome::kCreated;
}

absl::Status Uploads::StageError(const UploadRecord& upload, std::string_view view_name,
                                 const absl::Status& error) {
  RETURN_IF_ERROR(Kind<ViewRecord>::ParentOf(view_name).status());
  RETURN_IF_ERROR(CountAll());
  ASSIGN_OR_RETURN(const auto found, OpenOf(upload));
  Open& open = *found;
  absl::ReaderMutexLock use(&open.in_use);
  if (!open.end.ok()) return open.end;
  const std::string name(view_name);
  {
    absl::MutexLock lock(&open.names);
    open.AwaitStored(name);
    if (open.Find(name) != nullptr || open.views.size() >= kMaxStagedViews) return absl::OkStatus();
    RETURN_IF_ERROR(CountNew(open));
    open.views[name] = {"", false};
  }
  StagedViewRecord staged;
  staged.mutable_error()->set_code(static_cast<int>(error.code()));
  staged.mutable_error()->set_message(std::string(error.message()));
  return Write(open, name, staged, nullptr);
}

// Of a view that is in `open.views` and not stored; removes it from there on an error.
absl::Status Uploads::Write(Open& open, const std::string& view_name,
                            const StagedViewRecord& record, const std::string* packed_cloud) {
  const std::string key = StagedKey(open.record, view_name);
  rocksdb::WriteBatch batch;
  absl::Status status = database_.Put(Family::kStagedViews, key, record.SerializeAsString(), batch);
  if (packed_cloud != nullptr) {
    status.Update(database_.Put(Family::kClouds, key, *packed_cloud, batch));
  }
  if (status.ok()) status = database_.Write(batch);
  absl::MutexLock lock(&open.names);
  if (status.ok()) {
    open.views[view_name].is_stored = true;
    ++(packed_cloud == nullptr ? open.stored.errors : open.stored.views);
  } else {
    staged_views_ -= open.views.erase(view_name);
  }
  return status;
}

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
