// Scheduled backups.
#pragma once

#include <thread>

#include "absl/time/time.h"
#include "program/stop_flag.h"
#include "server/catalogue_backups.h"
#include "storage/backups.h"

namespace graspdb::server {

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
  absl::Duration UntilNext() const;
  bool Stopped(absl::Duration wait) { return stop_.Wait(absl::ToChronoNanoseconds(wait)); }

  CatalogueBackups& backups_;
  const absl::Duration interval_;
  const storage::BackupRetention retention_;
  StopFlag stop_;
  std::thread thread_;  // the last member: it uses the others
};

}  // namespace graspdb::server
