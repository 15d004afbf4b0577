// The catalogue in memory, always as of the last acknowledged change.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "recognition/base/cancellation.h"
#include "recognition/descriptors/descriptor.h"
#include "recognition/recognizer.h"
#include "server/live/filtered_snapshots.h"
#include "server/live/load_views.h"
#include "server/live/taught_poses.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Follows a storage::Catalogue: loads it once, then applies every change before the call that made
// the change returns. Records that cannot be used are left out. Readers take a snapshot and never
// wait for a writer. Thread-safe.
class LiveCatalogue {
 public:
  // Loads `catalogue`, which must outlive this. Descriptors with other parameters are
  // recomputed from the clouds, and stored; CANCELLED between two views after `is_cancelled`.
  static absl::StatusOr<std::unique_ptr<LiveCatalogue>> Follow(
      storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters,
      const recognition::IsCancelled& is_cancelled = {});
  ~LiveCatalogue();
  LiveCatalogue(const LiveCatalogue&) = delete;
  LiveCatalogue& operator=(const LiveCatalogue&) = delete;

  std::shared_ptr<const LiveSnapshot> snapshot() const;

  // Waits until the snapshot is newer than `revision`, or for `time` of the monotonic clock.
  void AwaitRevisionAfter(std::int64_t revision, std::chrono::nanoseconds time) const
      ABSL_LOCKS_EXCLUDED(mutex_);

  // The listener of the catalogue: applies a change, so that the next snapshot contains it. If that
  // fails (out of memory) or a previous change was missed, reloads all records; if that fails too,
  // logs it, and the next change or CatchUp() retries.
  void Apply(const storage::ChangeRecord& change) ABSL_LOCKS_EXCLUDED(change_mutex_);

  // Reloads all records if a change could not be applied; else does nothing. To be called
  // periodically. Writers wait meanwhile.
  void CatchUp() ABSL_LOCKS_EXCLUDED(change_mutex_);

  // Leaves out the views of this view's stable pose whose clouds are damaged, so that frames are
  // recognised with the others. Without others nothing is left out unless a file is lost: an error
  // is better than a look-alike in place of the object, but not for all objects at once. Reads all
  // of these clouds. Not for the listener of the catalogue.
  void LeaveOutDamaged(const std::string& view) ABSL_LOCKS_EXCLUDED(change_mutex_);

  // Calls `report` now, with false when a change could not be applied, and with true when the
  // snapshot has all changes again; each before the call that made the change returns. It must not
  // call this. Empty: ends the reports.
  void ReportAgreement(std::function<void(bool)> report) ABSL_LOCKS_EXCLUDED(change_mutex_);
  // The last result.
  bool agrees() const { return agrees_; }

  // Stored views and stable poses that cannot be used; the log has their names.
  std::int64_t left_out_count() const { return left_out_count_; }

  // Calls `work` with a snapshot. A view may be deleted between the snapshot and the loading of its
  // cloud, or left out as damaged: if `work` returns NOT_FOUND or DATA_LOSS and there is a newer
  // snapshot, it is retried.
  template <typename Work>
  auto WithSnapshot(const Work& work) const {
    return WithSnapshot({.include_drafts = true}, work);
  }
  // The same for the objects that a request of this visibility meets.
  template <typename Work>
  auto WithSnapshot(const Visibility& visibility, const Work& work) const {
    for (;;) {
      const std::shared_ptr<const LiveSnapshot> current = snapshot();
      auto result = work(*filters_.Get(current, visibility));
      const bool may_differ =
          absl::IsNotFound(result.status()) || absl::IsDataLoss(result.status());
      if (!may_differ || snapshot() == current) return result;
    }
  }

 private:
  using Snapshot = LiveSnapshot;

  LiveCatalogue(storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters);
  // Changes the catalogue, whose writers wait for change_mutex_, so it must not be locked.
  absl::Status Load(const recognition::IsCancelled& is_cancelled)
      ABSL_LOCKS_EXCLUDED(change_mutex_);
  // Reads all records. Returns the names of views that have no descriptor of the parameters, and
  // are left out.
  absl::StatusOr<std::vector<std::string>> Reload() ABSL_EXCLUSIVE_LOCKS_REQUIRED(change_mutex_);
  void Advance(const Snapshot& current, const storage::ChangeRecord& change)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(change_mutex_);
  using DamagedViews = std::map<std::shared_ptr<const recognition::TaughtView>, absl::Status>;
  void LeaveOut(const DamagedViews& damaged) ABSL_LOCKS_EXCLUDED(change_mutex_);
  void Recover() ABSL_EXCLUSIVE_LOCKS_REQUIRED(change_mutex_);
  void Publish(Snapshot snapshot);
  void SetLeftOut(std::set<std::string> names) ABSL_EXCLUSIVE_LOCKS_REQUIRED(change_mutex_);
  void SetAgrees(bool agrees) ABSL_EXCLUSIVE_LOCKS_REQUIRED(change_mutex_);

  storage::Catalogue& catalogue_;
  const recognition::DescriptorParameters parameters_;

  mutable absl::Mutex change_mutex_ ABSL_ACQUIRED_BEFORE(mutex_);
  bool stale_ ABSL_GUARDED_BY(change_mutex_) = false;  // a change is not in the snapshot
  std::set<std::string> left_out_ ABSL_GUARDED_BY(change_mutex_);
  std::function<void(bool)> report_ ABSL_GUARDED_BY(change_mutex_);
  // Written with change_mutex_ locked, which is held for seconds while all records are read.
  std::atomic<std::int64_t> left_out_count_ = 0;
  std::atomic<bool> agrees_ = true;

  mutable FilteredSnapshots filters_;
  mutable std::mutex publishing_;  // of published_
  mutable std::condition_variable published_;
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Snapshot> snapshot_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
