#include "server/backups/catalogue_backups.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "program/log/log_field.h"
#include "server/backups/backup_messages.h"
#include "server/base/errors.h"

namespace graspdb::server {
namespace {

absl::Time TimeOf(const storage::Backup& backup) {
  return absl::FromUnixNanos(
      google::protobuf::util::TimeUtil::TimestampToNanoseconds(backup.record.time()));
}

bool IsWithin(const std::filesystem::path& path, const std::filesystem::path& folder) {
  std::error_code error;
  const std::filesystem::path inner = std::filesystem::weakly_canonical(path, error);
  const std::filesystem::path outer = std::filesystem::weakly_canonical(folder, error);
  const std::filesystem::path way = inner.lexically_relative(outer);
  return !error && !way.empty() && *way.begin() != "..";
}

}  // namespace

absl::StatusOr<std::unique_ptr<CatalogueBackups>> CatalogueBackups::Open(
    const ServerOptions& options, storage::Catalogue& catalogue) {
  const std::string& folder = options.backup_dir;
  if (IsWithin(folder, catalogue.directory()) || IsWithin(catalogue.directory(), folder)) {
    return absl::FailedPreconditionError(absl::StrCat(
        "--backup-dir ", folder, " and the database ", catalogue.directory(),
        " contain each other, so that they would be lost together; choose another folder, on "
        "another disk"));
  }
  std::unique_ptr<CatalogueBackups> out(new CatalogueBackups(options, catalogue));
  const absl::Status claimed = out->backups_.Claim();
  if (absl::IsFailedPrecondition(claimed)) return claimed;
  out->NoteFailure(claimed, "open");
  out->Refresh();
  return out;
}

CatalogueBackups::CatalogueBackups(const ServerOptions& options, storage::Catalogue& catalogue)
    : interval_s_(options.backup_every_s),
      folder_(options.backup_dir),
      catalogue_(catalogue),
      backups_(options.backup_dir, static_cast<std::int64_t>(options.backup_rate_mib * (1 << 20))) {
}

absl::StatusOr<storage::Backup> CatalogueBackups::Create(const storage::BackupProgress& progress,
                                                         std::string_view request_id) {
  const absl::Time begin = absl::Now();
  const storage::BackupProgress until_stop = UntilStop(progress);
  absl::StatusOr<storage::Backup> made = backups_.Create(catalogue_, until_stop, request_id);
  if (made.ok() && !made->is_repeated) {
    if (auto intact = CheckSharedFiles(made->id, until_stop); !intact.ok()) made = intact;
  }
  NoteFailure(made.status(), "create");
  if (!made.ok()) {
    ReadDisk();
    return made;
  }
  Refresh();
  {
    absl::MutexLock lock(&mutex_);
    last_error_.clear();
  }
  spdlog::info("event=backup id={} revision={} bytes={} ms={}", made->id,
               made->record.meta().revision(), made->byte_count,
               absl::ToInt64Milliseconds(absl::Now() - begin));
  return made;
}

absl::Status CatalogueBackups::CheckSharedFiles(storage::BackupId id,
                                                const storage::BackupProgress& progress) {
  {
    absl::MutexLock lock(&mutex_);
    if (damaged_.empty()) return absl::OkStatus();
  }
  absl::Status verified = backups_.Verify(id, progress).status();
  NoteVerified(id, verified);  // in case that it cannot be deleted
  if (verified.ok()) return verified;
  backups_.Delete(id).IgnoreError();
  Refresh();
  if (!absl::IsDataLoss(verified)) return verified;
  return absl::DataLossError(
      absl::StrCat("no backup was made, since it would share a damaged file (", verified.message(),
                   "); stop the server, move the folder of its backups away, and start it again"));
}

absl::StatusOr<storage::Backup> CatalogueBackups::Verify(storage::BackupId id,
                                                         const storage::BackupProgress& progress) {
  // Reports a missing disk, as reading alone would report a missing backup.
  if (auto claimed = backups_.Claim(); !claimed.ok()) {
    NoteFailure(claimed, "verify");
    ReadDisk();
    return claimed;
  }
  absl::StatusOr<storage::Backup> verified = backups_.Verify(id, UntilStop(progress));
  NoteVerified(id, verified.status());
  NoteFailure(verified.status(), "verify");
  Refresh();
  return verified;
}

absl::StatusOr<std::vector<storage::Backup>> CatalogueBackups::List() {
  RETURN_IF_ERROR(backups_.Claim());
  ASSIGN_OR_RETURN(std::vector<storage::Backup> listed, backups_.List());
  absl::MutexLock lock(&mutex_);
  for (storage::Backup& backup : listed) {
    const auto damage = damaged_.find(backup.id);
    if (backup.state.ok() && damage != damaged_.end()) backup.state = damage->second;
  }
  return listed;
}

absl::Status CatalogueBackups::Delete(storage::BackupId id) {
  absl::Status deleted = backups_.Delete(id);
  NoteFailure(deleted, "delete");
  if (deleted.ok()) spdlog::info("event=backup_deleted id={}", id);
  Refresh();
  return deleted;
}

absl::Status CatalogueBackups::DeleteOld(const storage::BackupRetention& retention,
                                         absl::Time now) {
  storage::BackupRetention of_intact = retention;
  {
    absl::MutexLock lock(&mutex_);
    for (const auto& [id, damage] : damaged_) of_intact.damaged.insert(id);
  }
  const auto deleted = backups_.DeleteOld(of_intact, now);
  NoteFailure(deleted.status(), "delete");
  Refresh();
  if (!deleted.ok()) return deleted.status();
  for (const storage::BackupId id : *deleted) spdlog::info("event=backup_deleted id={}", id);
  return absl::OkStatus();
}

std::map<std::string, storage::BackupId> CatalogueBackups::NewestWith(
    const std::vector<std::string>& files) const {
  std::set<storage::BackupId> damaged;
  {
    absl::MutexLock lock(&mutex_);
    for (const auto& [id, damage] : damaged_) damaged.insert(id);
  }
  auto found = backups_.FindFiles(catalogue_.id(), files, damaged);
  return found.ok() ? *std::move(found) : std::map<std::string, storage::BackupId>();
}

absl::StatusOr<storage::Backup> CatalogueBackups::Compare(storage::BackupId id,
                                                          const storage::BackupProgress& progress,
                                                          storage::DifferenceVisitor visit) const {
  return backups_.Compare(id, catalogue_, UntilStop(progress), visit);
}

storage::BackupProgress CatalogueBackups::UntilStop(const storage::BackupProgress& progress) const {
  storage::BackupProgress out = progress;
  out.is_cancelled = [this, is_cancelled = progress.is_cancelled] {
    return stopped_ || (is_cancelled && is_cancelled());
  };
  return out;
}

void CatalogueBackups::ReadDisk() {
  std::error_code error;
  const std::filesystem::space_info disk = std::filesystem::space(folder_, error);
  absl::MutexLock lock(&mutex_);
  disk_.reset();
  if (!error) disk_ = disk;
}

void CatalogueBackups::Refresh() {
  ReadDisk();
  const auto listed = backups_.List();
  if (!listed.ok()) return;  // the operation before has reported it
  absl::MutexLock lock(&mutex_);
  // The next backup may get the number of a deleted one.
  std::erase_if(damaged_, [&](const auto& damaged) {
    return !std::ranges::binary_search(*listed, damaged.first, {}, &storage::Backup::id);
  });
  count_ = 0;
  last_good_.reset();
  for (const storage::Backup& backup : *listed) {
    if (!backup.state.ok() || damaged_.contains(backup.id)) continue;
    ++count_;
    last_good_ = backup;
  }
}

void CatalogueBackups::NoteVerified(storage::BackupId id, const absl::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (status.ok()) damaged_.erase(id);
  if (absl::IsDataLoss(status)) damaged_.insert_or_assign(id, status);
}

void CatalogueBackups::NoteFailure(const absl::Status& status, std::string_view action) {
  // Nothing is wrong with the backups after one of these.
  if (status.ok() || absl::IsAborted(status) || absl::IsCancelled(status) ||
      absl::IsNotFound(status)) {
    return;
  }
  {
    absl::MutexLock lock(&mutex_);
    last_error_ = BoundedText(std::string(status.message()), kMaxMessageBytes);
    last_error_time_ = absl::Now();
  }
  spdlog::error("event=backup_failed action={} error={}", action,
                LogField(std::string(status.message())));
}

v1::BackupStatus CatalogueBackups::Status() const {
  absl::MutexLock lock(&mutex_);
  v1::BackupStatus out;
  out.set_backup_count(count_);
  out.set_interval_s(interval_s_);
  if (last_good_) {
    *out.mutable_last_good_backup() = BackupToProto(*last_good_);
    out.set_last_good_age_s(absl::ToDoubleSeconds(absl::Now() - TimeOf(*last_good_)));
  }
  if (disk_) {
    out.mutable_disk()->set_available_byte_count(static_cast<std::int64_t>(disk_->available));
    out.mutable_disk()->set_byte_count(static_cast<std::int64_t>(disk_->capacity));
  }
  if (!last_error_.empty()) {
    out.set_last_error(last_error_);
    *out.mutable_last_error_time() = google::protobuf::util::TimeUtil::NanosecondsToTimestamp(
        absl::ToUnixNanos(last_error_time_));
  }
  return out;
}

std::optional<absl::Time> CatalogueBackups::LastGoodTime() const {
  absl::MutexLock lock(&mutex_);
  if (!last_good_) return std::nullopt;
  return TimeOf(*last_good_);
}

}  // namespace graspdb::server
