#include "storage/changes/change_log.h"

#include <string>
#include <utility>

#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "storage/base/restore_advice.h"
#include "storage/changes/schema.h"
#include "storage/database/family.h"
#include "storage/database/revision_floor.h"
#include "storage/records/record_list.h"

namespace graspdb::storage {
namespace {

// Changes between two writes of the revision floor, which costs about three of them.
constexpr std::int64_t kFloorInterval = 256;

}  // namespace

ChangeLog::ChangeLog(Database& database, MetaRecord meta, std::int64_t keep, Clock clock)
    : database_(database),
      keep_(keep),
      clock_(std::move(clock)),
      floor_(meta.revision()),
      meta_(std::move(meta)) {}

absl::Status ChangeLog::Mutate(absl::FunctionRef<absl::Status(ChangeBatch&)> fill,
                               WritePurpose purpose) {
  RETURN_IF_ERROR(CheckNotInListener());
  absl::MutexLock lock(&writer_mutex_);
  RETURN_IF_ERROR(Settle());
  ChangeBatch batch(
      database_, meta(),
      google::protobuf::util::TimeUtil::NanosecondsToTimestamp(absl::ToUnixNanos(clock_())));
  RETURN_IF_ERROR(fill(batch));
  if (batch.changes().empty()) return absl::OkStatus();
  return Commit(batch, purpose);
}

// Once the database can be written again it has no failed batch: it has what its memtables had, and
// a batch gets there after the log. Read nevertheless, since a further change must not reuse a
// revision; followers see that they missed one.
absl::Status ChangeLog::Settle() {
  if (!is_uncertain_) return absl::OkStatus();
  RETURN_IF_ERROR(database_.Recover());
  ASSIGN_OR_RETURN(auto stored, ReadMeta(database_));
  absl::MutexLock lock(&meta_mutex_);
  meta_ = std::move(stored);
  is_uncertain_ = false;
  return absl::OkStatus();
}

absl::Status ChangeLog::Commit(ChangeBatch& batch, WritePurpose purpose) {
  RETURN_IF_ERROR(batch.Finish(keep_));
  if (auto written = database_.Write(batch.rocks(), purpose); !written.ok()) {
    is_uncertain_ = is_uncertain_ || !absl::IsResourceExhausted(written);
    return written;
  }
  {
    absl::MutexLock lock(&meta_mutex_);
    meta_ = batch.meta();
  }
  RaiseFloor(batch.meta().revision());
  Notify(batch.changes());
  return absl::OkStatus();
}

void ChangeLog::RaiseFloor(std::int64_t revision) {
  if (revision < floor_ + kFloorInterval) return;
  // An older floor is valid too; it only detects less.
  WriteRevisionFloor(database_.directory(), revision).IgnoreError();
  floor_ = revision;
}

void ChangeLog::Notify(const std::vector<ChangeRecord>& changes) {
  if (!listener_) return;
  notifying_thread_ = std::this_thread::get_id();
  for (const ChangeRecord& change : changes) {
    try {
      listener_(change);
    } catch (...) {  // NOLINT(bugprone-empty-catch): see Mutate()
    }
  }
  notifying_thread_ = std::thread::id();
}

absl::Status ChangeLog::CheckNotInListener() const {
  if (notifying_thread_.load() != std::this_thread::get_id()) return absl::OkStatus();
  return absl::FailedPreconditionError(
      "the catalogue cannot be changed from within its change listener; do it from another thread "
      "after the listener has returned");
}

absl::Status ChangeLog::PauseChanges(
    absl::FunctionRef<absl::Status(const MetaRecord&, absl::FunctionRef<void()>)> work) {
  RETURN_IF_ERROR(CheckNotInListener());
  absl::ReleasableMutexLock lock(&writer_mutex_);
  RETURN_IF_ERROR(Settle());
  // The log may have a change that was reported as failed.
  RETURN_IF_ERROR(database_.Recover());
  return work(meta(), [&lock] { lock.Release(); });
}

absl::StatusOr<std::int64_t> ChangeLog::Subscribe(Listener listener) {
  RETURN_IF_ERROR(CheckNotInListener());
  absl::MutexLock lock(&writer_mutex_);
  listener_ = std::move(listener);
  return meta().revision();
}

MetaRecord ChangeLog::meta() const {
  absl::MutexLock lock(&meta_mutex_);
  return meta_;
}

absl::StatusOr<std::vector<ChangeRecord>> ChangeLog::Read(std::int64_t after_revision,
                                                          std::size_t limit) const {
  std::vector<ChangeRecord> changes;
  if (after_revision < 0 || limit == 0) {
    return absl::InvalidArgumentError(
        "give a revision of 0 or more and a limit of at least 1 to read changes");
  }
  // A snapshot: old change records may be deleted meanwhile.
  const Database::Snapshot snapshot = database_.TakeSnapshot();
  ASSIGN_OR_RETURN(const auto meta, ReadMeta(database_, snapshot.get()));
  if (after_revision < meta.change_horizon()) {
    return absl::OutOfRangeError("changes up to revision " + std::to_string(meta.change_horizon()) +
                                 " are no longer kept; read all records and continue from their "
                                 "revision, or keep more changes");
  }
  std::int64_t expected = after_revision;
  std::size_t bytes = 0;
  const absl::Status scanned = database_.Scan(
      Family::kChanges, "", ChangeKey(after_revision),
      [&](std::string_view key, std::string_view value) -> absl::StatusOr<bool> {
        ChangeRecord change;
        ++expected;
        if (key != ChangeKey(expected) ||
            !change.ParseFromArray(value.data(), static_cast<int>(value.size())) ||
            change.revision() != expected) {
          return absl::DataLossError("the change record of revision " + std::to_string(expected) +
                                     " is missing or damaged; " + std::string(kRestoreAdvice));
        }
        changes.push_back(std::move(change));
        bytes += value.size();
        return changes.size() < limit && bytes < kMaxPageBytes;
      },
      snapshot.get());
  if (!scanned.ok()) return scanned;
  return changes;
}

}  // namespace graspdb::storage
