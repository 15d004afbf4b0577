#include "server/backup_schedule.h"

#include <algorithm>
#include <optional>

#include "absl/time/clock.h"
#include "server/background.h"

namespace graspdb::server {
namespace {

// A disk that was full or missing is back within this time; a shorter interval would fill the log.
constexpr absl::Duration kRetryAfterFailure = absl::Minutes(10);
// The clock may be set meanwhile.
constexpr absl::Duration kLongestWait = absl::Minutes(1);

}  // namespace

BackupSchedule::BackupSchedule(CatalogueBackups& backups, absl::Duration interval,
                               storage::BackupRetention retention)
    : backups_(backups), interval_(interval), retention_(retention), thread_([this] {
        LowerPriority();
        Run();
      }) {}

BackupSchedule::~BackupSchedule() {
  stop_.Raise();
  backups_.Stop();
  thread_.join();
}

void BackupSchedule::Run() {
  while (!Stopped(std::min(UntilNext(), kLongestWait))) {
    if (UntilNext() > absl::ZeroDuration()) continue;
    absl::Status done = backups_.Create({}).status();
    if (done.ok()) done = backups_.DeleteOld(retention_);
    if (!done.ok() && Stopped(std::min(interval_, kRetryAfterFailure))) return;
  }
}

absl::Duration BackupSchedule::UntilNext() const {
  const std::optional<absl::Time> last = backups_.LastGoodTime();
  const absl::Time now = absl::Now();
  // A backup of the future was made before the clock was set back.
  if (!last || *last > now) return absl::ZeroDuration();
  return std::max(absl::ZeroDuration(), *last + interval_ - now);
}

}  // namespace graspdb::server
