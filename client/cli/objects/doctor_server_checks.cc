#include <google/protobuf/util/time_util.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/cli/base/cache_text.h"
#include "client/cli/base/counted.h"
#include "client/cli/objects/doctor_checks.h"
#include "program/text/printable_text.h"

namespace graspdb::client {
namespace {

// Scheduled backups are missing at twice their interval, as for the alert GraspdbBackupOld.
constexpr double kMissedIntervals = 2;
// Without a schedule: a week of teaching is lost with the disk.
constexpr double kOldBackupS = 7 * 24 * 3600.0;
// The first scheduled backup of a large catalogue takes minutes; as for the alert
// GraspdbBackupMissing.
constexpr double kFirstBackupS = 3600;
// Share of a file system that stays free, as for the alert GraspdbDiskLow.
constexpr double kMinFreeShare = 0.1;
// Two weeks, as for the alert GraspdbCertificateExpires.
constexpr absl::Duration kRenewNow = absl::Hours(14 * 24);
// A month before, someone can still plan it.
constexpr absl::Duration kRenewSoon = absl::Hours(30 * 24);
// Clocks that are synchronised differ by less than a second; the shortest limits by the clock are
// minutes.
constexpr absl::Duration kMaxClockDifference = absl::Seconds(60);

constexpr char kServer[] = "server";

absl::Time TimeFrom(const google::protobuf::Timestamp& time) {
  return absl::FromUnixNanos(google::protobuf::util::TimeUtil::TimestampToNanoseconds(time));
}

std::string MinuteText(absl::Time time) {
  return absl::FormatTime("%Y-%m-%d %H:%M %Ez", time, absl::LocalTimeZone());
}

std::string HoursText(double seconds) { return absl::StrFormat("%.1f h", seconds / 3600); }

// Compactions and backups may write all files of the database again before they delete the old
// ones.
void CheckDisk(const v1::DiskSpace& disk, std::int64_t database_bytes, const std::string& of,
               const std::string& advice, Findings* out) {
  const std::int64_t available = disk.available_byte_count();
  const auto share = kMinFreeShare * static_cast<double>(disk.byte_count());
  if (static_cast<double>(available) >= share && available >= database_bytes) return;
  AddWarning(out, kServer, "the disk of its ", of, " has only ", BytesText(available), " of ",
             BytesText(disk.byte_count()), " left, and the database has ",
             BytesText(database_bytes), "; ", advice);
}

// What a file that cannot be used means.
std::string EffectOf(const std::string& flag) {
  if (flag == "--identities") {
    return "; the identities from before are used, and revocations in the file have no effect: "
           "correct it";
  }
  if (flag == "--audit-log") return "; the last audit record is lost: repair it";
  return "; new connections may be refused: replace certificate and key";
}

}  // namespace

void CheckBackups(const v1::CatalogStatus& status, Findings* out) {
  if (!status.has_backup()) {
    if (status.view_count() == 0) return;
    AddAdvice(out, kServer,
              "makes no backups; start it with --backup-dir on another disk, and --backup-every "
              "24h");
    return;
  }
  const v1::BackupStatus& backup = status.backup();
  const bool is_scheduled = backup.interval_s() > 0;
  if (!backup.last_error().empty()) {
    AddWarning(out, kServer, "making, verifying or deleting a backup failed: ",
               PrintableText(backup.last_error()), "; then run: graspdb backup create");
  }
  if (!backup.has_last_good_backup()) {
    if (is_scheduled && backup.last_error().empty() && status.uptime_s() < kFirstBackupS) return;
    AddWarning(out, kServer, "has no good backup; run: graspdb backup create");
    return;
  }
  const double limit_s = is_scheduled ? kMissedIntervals * backup.interval_s() : kOldBackupS;
  if (backup.last_good_age_s() <= limit_s) return;
  AddWarning(
      out, kServer, "its last good backup is ", HoursText(backup.last_good_age_s()), " old, ",
      is_scheduled ? absl::StrCat("and one is scheduled every ", HoursText(backup.interval_s()),
                                  "; check the disk of --backup-dir")
                   : "and none is scheduled; give it --backup-every 24h",
      ", and run: graspdb backup create");
}

void CheckDisks(const v1::CatalogStatus& status, Findings* out) {
  const v1::ServerState& state = status.server_state();
  if (state.has_database_disk()) {
    CheckDisk(state.database_disk(), state.database_byte_count(), "database",
              "free space: when it is full, changes are rejected. Interrupted imports take some: "
              "graspdb uploads list",
              out);
  }
  if (status.backup().has_disk()) {
    CheckDisk(status.backup().disk(), state.database_byte_count(), "backups",
              "free space, lower --backup-keep, or run: graspdb backup delete", out);
  }
}

void CheckWrites(const v1::ServerState& state, Findings* out) {
  if (!state.has_write_fault()) return;
  AddError(out, kServer, "writes fail since ", MinuteText(TimeFrom(state.write_fault().time())),
           ", while it still recognises: ", PrintableText(state.write_fault().error()));
}

void CheckDatabaseFiles(const v1::ServerState& state, Findings* out) {
  for (const v1::DamagedFile& file : state.damaged_files()) {
    AddError(out, kServer, "its database's file ", PrintableText(file.name()), " is damaged (",
             PrintableText(file.error()), "); ",
             file.backup().empty()
                 ? "no backup of this catalogue has it: teach its views again "
                   "(event=record_left_out in the log)"
                 : absl::StrCat(PrintableText(file.backup()),
                                " has it: stop the server, and restore that backup "
                                "into an empty folder"));
  }
}

void CheckFiles(const v1::ServerState& state, Findings* out) {
  bool is_audit_broken = false;
  for (const v1::FileFault& fault : state.file_faults()) {
    is_audit_broken = is_audit_broken || fault.flag() == "--audit-log";
    AddError(out, kServer, fault.error(), ", since ", MinuteText(TimeFrom(fault.time())),
             EffectOf(fault.flag()));
  }
  if (state.lost_audit_record_count() == 0 || is_audit_broken) return;
  AddWarning(out, kServer, "lost ", Counted(state.lost_audit_record_count(), "audit record"),
             " since its start; its log has the reason (event=audit_not_written): "
             "check the disk of --audit-log");
}

void CheckCertificate(std::string_view subject, std::string_view flag, absl::Time end,
                      absl::Time now, Findings* out) {
  const absl::Duration left = end - now;
  if (left >= kRenewSoon) return;
  const bool is_expired = left <= absl::ZeroDuration();
  const Severity severity = is_expired         ? Severity::kError
                            : left < kRenewNow ? Severity::kWarning
                                               : Severity::kAdvice;
  AddFinding(out, severity, subject, "its certificate (", std::string(flag), ") ",
             is_expired ? "expired on " : "expires on ", MinuteText(end),
             "; renew it and replace the files: they are read again without a "
             "restart");
}

void CheckClock(const v1::ServerState& state, absl::Time before, absl::Time after, Findings* out) {
  const absl::Time time = TimeFrom(state.time());
  const absl::Duration ahead = time - after;
  const absl::Duration behind = before - time;
  const absl::Duration difference = std::max(ahead, behind);
  if (difference <= kMaxClockDifference) return;
  AddWarning(out, kServer, "its clock is ", absl::ToInt64Seconds(difference), " s ",
             ahead > behind ? "ahead of" : "behind",
             " this machine's; synchronise both (NTP): certificates and the ages of "
             "backups, deleted objects and imports go by it");
}

void CheckIndex(const v1::CatalogStatus& first, const v1::CatalogStatus& later, Findings* out) {
  const v1::ServerState& state = later.server_state();
  if (!state.serving()) {
    AddError(out, kServer,
             "recognises with an old catalogue, since a change could not be applied in memory "
             "(event=change_not_applied); give it memory, or restart it");
  } else if (first.catalog_id() == later.catalog_id() &&
             state.index_revision() < first.catalog_revision()) {
    AddWarning(out, kServer, "its index has revision ", state.index_revision(),
               ", but the catalogue ", first.catalog_revision(),
               "; run doctor again: if it stays so after a large import, keep the server's "
               "log for a bug report, and restart it");
  }
}

}  // namespace graspdb::client
