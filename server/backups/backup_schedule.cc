#include "server/backups/backup_schedule.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "absl/time/clock.h"
#include "program/log/log_field.h"
#include "server/base/background.h"

namespace graspdb::server {
namespace {

// A disk that was full or missing is back within this time; a shorter interval would fill the log.
constexpr absl::Duration kRetryAfterFailure = absl::Minutes(10);
// The clock may be set meanwhile.
constexpr absl::Duration kLongestWait = absl::Minutes(1);

}  // namespace

absl::Duration BackupRounds::Run(absl::Time wall, Clock::time_point monotonic) {
  const absl::Duration wait = UntilNext(wall);
  if (wait > absl::ZeroDuration()) return std::min(wait, kLongestWait);
  absl::Status done = backups_.Create({}).status();
  const absl::Time now = std::min(wall, start_wall_ + absl::FromChrono(monotonic - start_));
  if (done.ok()) done = backups_.DeleteOld(retention_, now);
  // The new one is listed as good, unless its disk is at fault: not made again and again.
  const std::optional<absl::Time> last = backups_.LastGoodTime();
  if (!done.ok() || !last || *last < wall) return std::min(interval_, kRetryAfterFailure);
  return absl::ZeroDuration();  // the times are those of before the backup
}

absl::Duration BackupRounds::UntilNext(absl::Time wall) const {
  const std::optional<absl::Time> last = backups_.LastGoodTime();
  // A backup of the future was made before the clock was set back.
  if (!last || *last > wall) return absl::ZeroDuration();
  return std::max(absl::ZeroDuration(), *last + interval_ - wall);
}

BackupSchedule::BackupSchedule(CatalogueBackups& backups, absl::Duration interval,
                               storage::BackupRetention retention)
    : backups_(backups),
      rounds_(backups, interval, std::move(retention), absl::Now(), BackupRounds::Clock::now()),
      thread_([this] {
        LowerPriority();
        Run();
      }) {}

BackupSchedule::~BackupSchedule() {
  stop_.Raise();
  backups_.Stop();
  thread_.join();
}

void BackupSchedule::Run() {
  absl::Duration wait;
  while (!stop_.Wait(absl::ToChronoNanoseconds(wait))) {
    const absl::Status ran = Guarded([&] {
      wait = rounds_.Run(absl::Now(), BackupRounds::Clock::now());
      return absl::OkStatus();
    });
    if (ran.ok()) continue;
    wait = kRetryAfterFailure;
    spdlog::error("event=backup_failed action=schedule error={}",
                  LogField(std::string(ran.message())));
  }
}

}  // namespace graspdb::server
