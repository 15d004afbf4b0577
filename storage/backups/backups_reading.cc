// Backups: the functions that read a backup's contents.
#include <algorithm>
#include <filesystem>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "base/status_macros.h"
#include "rocksdb/env.h"
#include "rocksdb/iterator.h"
#include "rocksdb/snapshot.h"
#include "storage/backups/backup_engine.h"
#include "storage/backups/backups.h"
#include "storage/backups/operation_mark.h"
#include "storage/backups/restore_folder.h"
#include "storage/backups/watched_reads.h"
#include "storage/changes/schema.h"
#include "storage/database/database.h"
#include "storage/database/database_directory.h"
#include "storage/database/log_check.h"
#include "storage/database/revision_floor.h"
#include "storage/database/rocksdb_status.h"

namespace graspdb::storage {

// One state of a database; without a snapshot, of one that does not change.
struct DatabaseState {
  const Database& database;
  const rocksdb::Snapshot* snapshot = nullptr;
};

namespace {

// Null at the end, or where an older database has no such family.
std::unique_ptr<rocksdb::Iterator> RowsOf(const DatabaseState& state, Family family) {
  if (!state.database.HasFamily(family)) return nullptr;
  return state.database.Rows(family, state.snapshot);
}

absl::Status StatusOf(const rocksdb::Iterator* rows) {
  return rows == nullptr ? absl::OkStatus() : FromRocksDb(rows->status(), "compare the records");
}

// Merges the rows of both; each row is in one of the states or in both.
absl::Status CompareRows(rocksdb::Iterator* before, rocksdb::Iterator* after,
                         const BackupProgress& progress, DifferenceVisitor visit) {
  const auto at_row = [](const rocksdb::Iterator* rows) {
    return rows != nullptr && rows->Valid();
  };
  while (at_row(before) || at_row(after)) {
    if (progress.IsCancelled()) return absl::CancelledError("the comparison was cancelled");
    int order = at_row(before) ? -1 : 1;
    if (at_row(before) && at_row(after)) order = before->key().compare(after->key());
    Difference difference;
    difference.kind = order == 0  ? Difference::Kind::kChanged
                      : order < 0 ? Difference::Kind::kRemoved
                                  : Difference::Kind::kAdded;
    if (order != 0 || before->value() != after->value()) {
      difference.name = (order <= 0 ? before : after)->key().ToString();
      RETURN_IF_ERROR(visit(difference));
    }
    if (order <= 0) before->Next();
    if (order >= 0) after->Next();
  }
  absl::Status read = StatusOf(before);
  read.Update(StatusOf(after));
  return read;
}

// Visits what changes between two states: objects, then stable poses, views and cells, each by
// name. Reads the rows of both once, in their order. CANCELLED, or the error of `visit`.
absl::Status FindDifferences(const DatabaseState& before, const DatabaseState& after,
                             const BackupProgress& progress, DifferenceVisitor visit) {
  for (const Family family :
       {Family::kObjects, Family::kStablePoses, Family::kViews, Family::kCells}) {
    const auto rows_before = RowsOf(before, family);
    const auto rows_after = RowsOf(after, family);
    RETURN_IF_ERROR(CompareRows(rows_before.get(), rows_after.get(), progress, visit));
  }
  return absl::OkStatus();
}

absl::Status Cancelled() { return absl::CancelledError("cancelled; nothing was changed"); }

// A backup that is open for reading.
struct OpenBackup {
  std::unique_ptr<rocksdb::Env> files;  // used by the engine
  std::unique_ptr<rocksdb::BackupEngineReadOnly> engine;
  rocksdb::BackupInfo info;
  Backup backup;
};

absl::StatusOr<OpenBackup> OpenBackupToRead(BackupId id, const std::string& directory,
                                            const BackupProgress& progress) {
  OpenBackup out;
  out.files = WatchReads(progress);
  auto engine = OpenToRead(directory, out.files.get());
  if (!engine.ok()) return progress.IsCancelled() ? Cancelled() : engine.status();
  out.engine = *std::move(engine);
  ASSIGN_OR_RETURN(out.info, FindBackup(*out.engine, id, directory));
  out.backup = DescribeBackup(out.info, directory);
  const int version = out.backup.record.meta().schema_version();
  if (version <= kSchemaVersion) return out;
  return absl::FailedPreconditionError(
      "backup " + std::to_string(id) + " in " + directory + " has schema version " +
      std::to_string(version) + "; this program supports up to " + std::to_string(kSchemaVersion) +
      "; use the newer program that made it");
}

// The status of reading all bytes of a backup.
absl::Status ReadStatus(const rocksdb::Status& status, const OpenBackup& open,
                        const std::string& directory, const std::string& action,
                        const BackupProgress& progress) {
  if (status.ok()) return absl::OkStatus();
  if (progress.IsCancelled()) return Cancelled();
  if (status.IsCorruption() || status.IsNotFound() || status.IsPathNotFound()) {
    return DamagedBackup(open.backup.id, directory, status.ToString());
  }
  return FromBackupEngine(status, action + " backup " + std::to_string(open.backup.id), directory);
}

// The database in a backup.
absl::StatusOr<std::unique_ptr<Database>> OpenContent(const OpenBackup& open) {
  return Database::OpenReadOnly(open.info.name_for_open, open.info.env_for_open.get());
}

// Whether a database has the revision that the backup's record names.
absl::Status CheckContent(const absl::StatusOr<std::unique_ptr<Database>>& database,
                          const OpenBackup& open, const std::string& directory) {
  if (!database.ok()) {
    return DamagedBackup(open.backup.id, directory, std::string(database.status().message()));
  }
  const auto meta = ReadMeta(**database);
  if (!meta.ok()) {
    return DamagedBackup(open.backup.id, directory, std::string(meta.status().message()));
  }
  if (meta->SerializeAsString() == open.backup.record.meta().SerializeAsString()) {
    return absl::OkStatus();
  }
  return DamagedBackup(open.backup.id, directory,
                       "it has revision " + std::to_string(meta->revision()) + " and not " +
                           std::to_string(open.backup.record.meta().revision()));
}

// Holds the lock of a database as a server does, so that none changes it meanwhile. A database
// whose lock is missing or may not be written has no server here.
class DatabaseLock {
 public:
  explicit DatabaseLock(const std::string& directory) {
    const std::string path = directory + "/LOCK";  // RocksDB's name
    std::error_code unknown;
    if (!std::filesystem::exists(path, unknown)) return;
    is_taken_ = IsLockTaken(rocksdb::Env::Default()->LockFile(path, &lock_));
  }
  ~DatabaseLock() {
    if (lock_ != nullptr) rocksdb::Env::Default()->UnlockFile(lock_).PermitUncheckedError();
  }
  DatabaseLock(const DatabaseLock&) = delete;
  DatabaseLock& operator=(const DatabaseLock&) = delete;

  // By another process.
  bool is_taken() const { return is_taken_; }

 private:
  rocksdb::FileLock* lock_ = nullptr;
  bool is_taken_ = false;
};

// The name in the database of a file in a backup. Those that backups share have more in theirs:
// 000012_s6ZZ...blob.
std::string DatabaseName(const std::filesystem::path& file) {
  const std::string stem = file.stem().string();
  return stem.substr(0, stem.find('_')) + file.extension().string();
}

// Gives a restored database an id of its own: its next changes get revisions that changes of the
// original had.
absl::Status GiveNewId(const std::string& directory) {
  ASSIGN_OR_RETURN(const auto database, Database::Open(directory, {.create_if_missing = false}));
  ASSIGN_OR_RETURN(auto meta, ReadMeta(*database));
  return RenewCatalogId(*database, meta);
}

}  // namespace

absl::StatusOr<Backup> Backups::Verify(BackupId id, const BackupProgress& progress) const {
  const OperationMark mark(running_);
  RETURN_IF_ERROR(mark.Check(directory_));
  ASSIGN_OR_RETURN(const auto open, OpenBackupToRead(id, directory_, progress));
  const rocksdb::Status verified = open.engine->VerifyBackup(id, /*verify_with_checksum=*/true);
  RETURN_IF_ERROR(ReadStatus(verified, open, directory_, "verify", progress));
  const absl::Status status = CheckContent(OpenContent(open), open, directory_);
  if (status.ok()) return open.backup;
  return progress.IsCancelled() ? Cancelled() : status;
}

absl::StatusOr<Backup> Backups::Restore(BackupId id, const std::string& database,
                                        const BackupProgress& progress) const {
  ASSIGN_OR_RETURN(const auto folder, RestoreFolder::Make(database));
  const std::string path = folder->path();
  // Ends before the folder, into which its threads write.
  ASSIGN_OR_RETURN(const auto open, OpenBackupToRead(id, directory_, progress));
  rocksdb::Status copied =
      open.engine->RestoreDBFromBackup(rocksdb::RestoreOptions(), id, path, path);
  // The error of a restore does not name the damaged file, that of a verification does.
  if (copied.IsCorruption()) {
    const rocksdb::Status verified = open.engine->VerifyBackup(id, /*verify_with_checksum=*/true);
    if (verified.IsCorruption()) copied = verified;
  }
  RETURN_IF_ERROR(ReadStatus(copied, open, directory_, "restore", progress));
  RETURN_IF_ERROR(CheckLogs(path));
  RETURN_IF_ERROR(CheckContent(Database::OpenReadOnly(path, nullptr), open, directory_));
  RETURN_IF_ERROR(GiveNewId(path));
  RETURN_IF_ERROR(WriteRevisionFloor(path, open.backup.record.meta().revision()));
  RETURN_IF_ERROR(folder->Publish());
  return open.backup;
}

absl::StatusOr<Backup> Backups::Compare(BackupId id, const Catalogue& catalogue,
                                        const BackupProgress& progress,
                                        DifferenceVisitor visit) const {
  const Database::Snapshot snapshot = catalogue.database_->TakeSnapshot();
  return CompareWith({*catalogue.database_, snapshot.get()}, id, progress, visit);
}

absl::StatusOr<Backup> Backups::Compare(BackupId id, const std::string& database,
                                        const BackupProgress& progress,
                                        DifferenceVisitor visit) const {
  ASSIGN_OR_RETURN(const auto found, InspectDirectory(database));
  if (found == DirectoryContent::kNothing) {
    return absl::NotFoundError("there is no database at " + database + "; check the path");
  }
  const DatabaseLock lock(database);
  if (lock.is_taken()) {
    return absl::FailedPreconditionError("the database at " + database +
                                         " is in use by another process; stop it, or compare with "
                                         "its catalogue: graspdb backup diff");
  }
  ASSIGN_OR_RETURN(const auto there, Database::OpenReadOnly(database, nullptr));
  return CompareWith({*there}, id, progress, visit);
}

absl::StatusOr<Backup> Backups::CompareWith(const DatabaseState& there, BackupId id,
                                            const BackupProgress& progress,
                                            DifferenceVisitor visit) const {
  ASSIGN_OR_RETURN(const auto open, OpenBackupToRead(id, directory_, progress));
  const auto content = OpenContent(open);
  absl::Status status = content.status();
  if (status.ok()) status = FindDifferences(there, {**content}, progress, visit);
  if (status.ok()) return open.backup;
  return progress.IsCancelled() ? Cancelled() : status;
}

absl::StatusOr<std::map<std::string, BackupId>> Backups::FindFiles(
    const std::string& catalog_id, const std::vector<std::string>& names,
    const std::set<BackupId>& left_out) const {
  absl::MutexLock lock(&listing_mutex_);
  ASSIGN_OR_RETURN(const auto engine, OpenToRead(directory_, nullptr));
  std::vector<rocksdb::BackupInfo> infos;  // the oldest first
  engine->GetBackupInfo(&infos, /*include_file_details=*/true);
  std::map<std::string, BackupId> out;
  for (const rocksdb::BackupInfo& info : infos) {
    const Backup backup = DescribeBackup(info, directory_);
    if (!backup.state.ok() || left_out.contains(backup.id) ||
        backup.record.meta().catalog_id() != catalog_id) {
      continue;
    }
    std::set<std::string> there;
    for (const rocksdb::BackupFileInfo& file : info.file_details) {
      there.insert(DatabaseName(file.relative_filename));
    }
    for (const std::string& name : names) {
      if (there.contains(name)) out[name] = backup.id;
    }
  }
  return out;
}

}  // namespace graspdb::storage
