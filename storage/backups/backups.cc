#include "storage/backups/backups.h"

#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "google/protobuf/util/time_util.h"
#include "rocksdb/utilities/stackable_db.h"
#include "storage/backups/backup_engine.h"
#include "storage/backups/operation_mark.h"
#include "storage/base/restore_advice.h"
#include "storage/changes/change_log.h"
#include "storage/database/database.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {
namespace {

constexpr std::string_view kLockFile = "LOCK";

// Names in a folder of backups: RocksDB's, ours, and one of new file systems.
constexpr std::array<std::string_view, 6> kFolderNames = {
    "meta", "private", "shared", "shared_checksum", kLockFile, "lost+found"};

// RocksDB deletes files that it does not know in some of these folders.
absl::Status CheckFolder(const std::string& directory) {
  std::error_code error;
  for (std::filesystem::directory_iterator entry(directory, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (std::ranges::find(kFolderNames, name) != kFolderNames.end()) continue;
    return absl::FailedPreconditionError(absl::StrCat("the folder ", directory,
                                                      " has other files (", name,
                                                      "); give an empty folder for the backups"));
  }
  return error ? CannotReadFolder(directory, error) : absl::OkStatus();
}

std::string LockPath(const std::string& directory) {
  return directory + "/" + std::string(kLockFile);
}

// Nothing if there is no file at the path, or it cannot be reached.
std::optional<FileId> FileAt(const std::string& path) {
  struct stat file {};
  if (stat(path.c_str(), &file) != 0) return std::nullopt;
  return FileId{.device = file.st_dev, .inode = file.st_ino};
}

bool IsLockIn(const std::string& directory, const FileId& lock_file) {
  return FileAt(LockPath(directory)) == lock_file;
}

// Forwards everything to a database that it does not own; calls `captured` when the files and
// their sizes are listed, after which changes of the database do not change the backup.
class CapturedDatabase : public rocksdb::StackableDB {
 public:
  CapturedDatabase(rocksdb::DB& database, absl::FunctionRef<void()> captured)
      : StackableDB(std::shared_ptr<rocksdb::DB>(&database, [](rocksdb::DB*) {})),
        captured_(captured) {}

  rocksdb::Status GetLiveFilesStorageInfo(
      const rocksdb::LiveFilesStorageInfoOptions& options,
      std::vector<rocksdb::LiveFileStorageInfo>* files) override {
    rocksdb::Status listed = StackableDB::GetLiveFilesStorageInfo(options, files);
    captured_();
    return listed;
  }

 private:
  absl::FunctionRef<void()> captured_;
};

}  // namespace

Backups::Backups(std::string directory, std::int64_t bytes_per_second)
    : directory_(std::move(directory)), bytes_per_second_(bytes_per_second) {}

Backups::~Backups() {
  if (lock_ != nullptr) rocksdb::Env::Default()->UnlockFile(lock_).PermitUncheckedError();
}

absl::Status Backups::Claim() {
  absl::MutexLock lock(&claim_mutex_);
  std::error_code error;
  const auto type = std::filesystem::status(directory_, error).type();
  if (error && type != std::filesystem::file_type::not_found) {
    return CannotReadFolder(directory_, error);
  }
  if (type != std::filesystem::file_type::directory) {
    return absl::UnavailableError("there is no folder " + directory_ +
                                  " for backups; make it, or mount its disk");
  }
  if (lock_ != nullptr) {
    if (IsLockIn(directory_, lock_file_)) return absl::OkStatus();
    // Another folder has the name, such as one on a disk that was mounted since.
    rocksdb::Env::Default()->UnlockFile(lock_).PermitUncheckedError();
    lock_ = nullptr;
  }
  RETURN_IF_ERROR(CheckFolder(directory_));
  const std::string path = LockPath(directory_);
  const rocksdb::Status locked = rocksdb::Env::Default()->LockFile(path, &lock_);
  if (IsLockTaken(locked)) {
    return absl::FailedPreconditionError("the folder " + directory_ +
                                         " is in use by another process; stop it or choose another "
                                         "--backup-dir");
  }
  if (!locked.ok()) return FromBackupEngine(locked, "make backups", directory_);
  if (const auto file = FileAt(path); file) lock_file_ = *file;
  // Makes its folders, so that an empty folder of backups can be listed.
  return OpenToWrite(directory_, bytes_per_second_, rocksdb::Env::Default()).status();
}

absl::StatusOr<std::optional<Backup>> Backups::FindMade(std::string_view request_id) const {
  if (request_id.empty()) return std::nullopt;
  ASSIGN_OR_RETURN(auto existing, List());
  for (Backup& backup : existing) {
    if (backup.state.ok() && backup.record.request_id() == request_id) return std::move(backup);
  }
  return std::nullopt;
}

absl::StatusOr<Backup> Backups::Create(Catalogue& catalogue, const BackupProgress& progress,
                                       std::string_view request_id) {
  RETURN_IF_ERROR(Claim());
  const OperationMark mark(running_);
  RETURN_IF_ERROR(mark.Check(directory_));
  ASSIGN_OR_RETURN(auto made_before, FindMade(request_id));
  if (made_before.has_value()) {
    made_before->is_repeated = true;
    return *std::move(made_before);
  }
  Database& database = *catalogue.database_;
  ASSIGN_OR_RETURN(const auto engine,
                   OpenToWrite(directory_, bytes_per_second_, database.rocks().GetEnv()));
  // Both before changes are paused, since they take longer; the logs of later changes become part
  // of the backup.
  RETURN_IF_ERROR(DeleteUnfinished(*engine, directory_));
  RETURN_IF_ERROR(database.Flush());

  std::int64_t bytes = 0;
  rocksdb::CreateBackupOptions options;
  options.progress_callback = [&] {
    progress.Report(bytes += kBackupProgressBytes);
    if (progress.IsCancelled()) engine->StopBackup();
  };
  rocksdb::BackupID id = 0;
  const auto copy = [&](const MetaRecord& meta, absl::FunctionRef<void()> release) {
    absl::Status cancelled = absl::CancelledError("the backup was cancelled");
    if (progress.IsCancelled()) return cancelled;
    BackupRecord record;
    *record.mutable_meta() = meta;
    record.set_request_id(std::string(request_id));
    *record.mutable_time() = google::protobuf::util::TimeUtil::NanosecondsToTimestamp(
        absl::ToUnixNanos(catalogue.log_->Now()));
    CapturedDatabase captured(database.rocks(), release);
    const rocksdb::Status made =
        engine->CreateNewBackupWithMetadata(options, &captured, EncodeBackupRecord(record), &id);
    if (made.IsIncomplete()) return cancelled;
    if (made.IsCorruption()) {
      return absl::DataLossError("no backup was made, since the database is damaged (" +
                                 made.ToString() + "); " + std::string(kRestoreAdvice));
    }
    return FromBackupEngine(made, "make a backup", directory_);
  };
  RETURN_IF_ERROR(catalogue.log_->PauseChanges(copy));
  ASSIGN_OR_RETURN(const auto info, FindBackup(*engine, id, directory_));
  return DescribeBackup(info, directory_);
}

absl::StatusOr<std::vector<Backup>> Backups::List() const {
  absl::MutexLock lock(&listing_mutex_);
  return ListLocked();
}

absl::StatusOr<std::vector<Backup>> Backups::ListLocked() const {
  ASSIGN_OR_RETURN(const auto engine, OpenToRead(directory_, nullptr));
  std::vector<rocksdb::BackupInfo> infos;
  engine->GetBackupInfo(&infos);
  std::vector<Backup> backups;
  backups.reserve(infos.size());
  for (const rocksdb::BackupInfo& info : infos) backups.push_back(DescribeBackup(info, directory_));
  std::vector<rocksdb::BackupID> damaged;
  engine->GetCorruptedBackups(&damaged);
  for (const rocksdb::BackupID id : damaged) {
    Backup& backup = backups.emplace_back();
    backup.id = id;
    backup.state = FindBackup(*engine, id, directory_).status();
  }
  std::ranges::sort(backups, {}, &Backup::id);
  return backups;
}

absl::Status Backups::Delete(BackupId id) {
  RETURN_IF_ERROR(Claim());
  const OperationMark mark(running_);
  RETURN_IF_ERROR(mark.Check(directory_));
  absl::MutexLock lock(&listing_mutex_);
  ASSIGN_OR_RETURN(const auto existing, ListLocked());
  if (std::ranges::find(existing, id, &Backup::id) == existing.end()) {
    return NoBackup(id, directory_);
  }
  return DeleteLocked({id});
}

absl::StatusOr<std::vector<BackupId>> Backups::DeleteOld(const BackupRetention& retention,
                                                         absl::Time now) {
  RETURN_IF_ERROR(Claim());
  const OperationMark mark(running_);
  RETURN_IF_ERROR(mark.Check(directory_));
  absl::MutexLock lock(&listing_mutex_);
  ASSIGN_OR_RETURN(const auto existing, ListLocked());
  std::vector<BackupId> old;
  std::int64_t newer = 0;  // intact ones
  for (auto backup = existing.rbegin(); backup != existing.rend(); ++backup) {
    if (!backup->state.ok() || retention.damaged.contains(backup->id)) continue;
    const absl::Duration age =
        now - absl::FromUnixNanos(
                  google::protobuf::util::TimeUtil::TimestampToNanoseconds(backup->record.time()));
    if (newer > 0 && (newer >= retention.count || age > retention.max_age)) {
      old.push_back(backup->id);
    }
    ++newer;
  }
  RETURN_IF_ERROR(DeleteLocked(old));
  return old;
}

absl::Status Backups::DeleteLocked(const std::vector<BackupId>& ids) {
  ASSIGN_OR_RETURN(const auto engine,
                   OpenToWrite(directory_, bytes_per_second_, rocksdb::Env::Default()));
  for (const BackupId id : ids) {
    RETURN_IF_ERROR(FromBackupEngine(engine->DeleteBackup(id),
                                     "delete backup " + std::to_string(id), directory_));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::storage
