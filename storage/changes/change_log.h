// The only write path of the catalogue: numbers the changes, makes them durable,
// notifies the listener. Internal to storage/.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "storage/changes/change_batch.h"
#include "storage/database/database.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// Safe from any thread.
class ChangeLog {
 public:
  using Clock = std::function<absl::Time()>;
  using Listener = std::function<void(const ChangeRecord&)>;

  // `database` must outlive the log. `meta` is the MetaRecord of the database. `keep` (at least 1)
  // change records are kept.
  ChangeLog(Database& database, MetaRecord meta, std::int64_t keep, Clock clock);

  // `fill` adds changes to a batch, which is committed atomically and durably; then the
  // listener is notified. One mutation at a time: the database does not change while
  // `fill` reads it. An error of `fill`, or a batch without a change, changes nothing.
  // FAILED_PRECONDITION from within the listener. RESOURCE_EXHAUSTED when the disk is full,
  // UNAVAILABLE while it fails: nothing changed. If the listener throws, the change remains, and
  // the listener gets the next one.
  absl::Status Mutate(absl::FunctionRef<absl::Status(ChangeBatch&)> fill,
                      WritePurpose purpose = WritePurpose::kAdd)
      ABSL_LOCKS_EXCLUDED(writer_mutex_, meta_mutex_);

  // Runs `work` while no change begins, until it calls `release` (once) or returns; it gets the
  // MetaRecord, which is the one on the disk. FAILED_PRECONDITION from within the listener,
  // RESOURCE_EXHAUSTED or UNAVAILABLE after a failed write.
  absl::Status PauseChanges(
      absl::FunctionRef<absl::Status(const MetaRecord& meta, absl::FunctionRef<void()> release)>
          work) ABSL_LOCKS_EXCLUDED(writer_mutex_, meta_mutex_);

  // The time of the clock. For the work of PauseChanges() before it releases, as for a writer.
  absl::Time Now() const { return clock_(); }

  // Sets the listener (empty: none) and returns the last revision before its first change.
  absl::StatusOr<std::int64_t> Subscribe(Listener listener)
      ABSL_LOCKS_EXCLUDED(writer_mutex_, meta_mutex_);

  // The current MetaRecord; never waits for a disk.
  MetaRecord meta() const ABSL_LOCKS_EXCLUDED(meta_mutex_);

  // Change records after a revision, oldest first, at most `limit`, and none after kMaxPageBytes;
  // OUT_OF_RANGE if some are no longer kept.
  absl::StatusOr<std::vector<ChangeRecord>> Read(std::int64_t after_revision,
                                                 std::size_t limit) const;

 private:
  absl::Status Settle() ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  absl::Status Commit(ChangeBatch& batch, WritePurpose purpose)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  void Notify(const std::vector<ChangeRecord>& changes)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  void RaiseFloor(std::int64_t revision) ABSL_EXCLUSIVE_LOCKS_REQUIRED(writer_mutex_);
  absl::Status CheckNotInListener() const;

  Database& database_;
  const std::int64_t keep_;
  const Clock clock_;

  absl::Mutex writer_mutex_ ABSL_ACQUIRED_BEFORE(meta_mutex_);
  Listener listener_ ABSL_GUARDED_BY(writer_mutex_);
  bool is_uncertain_ ABSL_GUARDED_BY(writer_mutex_) = false;  // whether the last batch was written
  std::int64_t floor_ ABSL_GUARDED_BY(writer_mutex_);
  std::atomic<std::thread::id> notifying_thread_;

  mutable absl::Mutex meta_mutex_;
  MetaRecord meta_ ABSL_GUARDED_BY(meta_mutex_);
};

}  // namespace graspdb::storage
