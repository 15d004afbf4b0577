// Scheduled backups.
#pragma once

#include <chrono>
#include <thread>
#include <utility>

#include "absl/time/time.h"
#include "program/base/stop_flag.h"
#include "server/backups/catalogue_backups.h"
#include "storage/backups/backups.h"

namespace graspdb::server {

// The schedule without its thread. Not thread-safe.
class BackupRounds {
 public:
  using Clock = std::chrono::steady_clock;

  // `backups` must outlive this. `wall` and `monotonic` are the times of now.
  BackupRounds(CatalogueBackups& backups, absl::Duration interval,
               storage::BackupRetention retention, absl::Time wall, Clock::time_point monotonic)
      : backups_(backups),
        interval_(interval),
        retention_(std::move(retention)),
        start_wall_(wall),
        start_(monotonic) {}

  // If the newest good backup is older than the interval, or of the future, or there is none, makes
  // one and deletes old ones. Returns the time until the next call: at most a minute, or ten after
  // a failure. `wall` and `monotonic` are the times of now. Where the wall clock was set ahead
  // after the start, it makes a backup due, but only the time that really passed makes others so
  // old that they are deleted.
  absl::Duration Run(absl::Time wall, Clock::time_point monotonic);

 private:
  absl::Duration UntilNext(absl::Time wall) const;

  CatalogueBackups& backups_;
  const absl::Duration interval_;
  const storage::BackupRetention retention_;
  const absl::Time start_wall_;
  const Clock::time_point start_;
};

// Makes a backup whenever the newest good one is older than the interval, at once if there is none,
// and then deletes old ones. Runs on a thread of low priority (LowerPriority). After a failure,
// which is logged, it tries again every ten minutes.
class BackupSchedule {
 public:
  // `backups` must outlive this.
  BackupSchedule(CatalogueBackups& backups, absl::Duration interval,
                 storage::BackupRetention retention);
  // Cancels all operations on `backups` and waits for the running one.
  ~BackupSchedule();
  BackupSchedule(const BackupSchedule&) = delete;
  BackupSchedule& operator=(const BackupSchedule&) = delete;

 private:
  void Run();

  CatalogueBackups& backups_;
  BackupRounds rounds_;  // for the thread
  StopFlag stop_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace graspdb::server
