#include "storage/backups/backup_engine.h"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "base/status_macros.h"
#include "storage/base/crc32c.h"
#include "storage/base/little_endian.h"

namespace graspdb::storage {
namespace {

rocksdb::BackupEngineOptions MakeOptions(const std::string& directory) {
  // RocksDB cannot open the database in a backup by a relative path.
  std::error_code unknown;
  const std::filesystem::path absolute = std::filesystem::absolute(directory, unknown);
  rocksdb::BackupEngineOptions options(unknown ? directory : absolute.string());
  options.callback_trigger_interval_size = kBackupProgressBytes;
  return options;
}

// For RocksDB a folder that may not be read is a missing one, so that there would be no backups, or
// damaged ones.
absl::Status CheckFoldersReadable(const std::string& directory) {
  using Entries = std::filesystem::directory_iterator;
  const auto check = [](const std::filesystem::path& folder) {
    std::error_code error;
    const Entries entries(folder, error);
    const bool is_missing = error == std::errc::no_such_file_or_directory ||
                            error == std::errc::not_a_directory;  // perhaps deleted meanwhile
    return error && !is_missing ? CannotReadFolder(folder.string(), error) : absl::OkStatus();
  };
  const std::filesystem::path root = directory;
  absl::Status status = check(root);
  for (const char* name : {"meta", "shared", "shared_checksum", "private"}) {
    if (status.ok()) status = check(root / name);
  }
  std::error_code ended;
  for (Entries entry(root / "private", ended), end; status.ok() && !ended && entry != end;
       entry.increment(ended)) {
    status = check(entry->path());
  }
  return status;
}

}  // namespace

std::string EncodeBackupRecord(const BackupRecord& record) {
  const std::string bytes = record.SerializeAsString();
  return ToLittleEndian(Crc32c(bytes)) + bytes;
}

absl::StatusOr<BackupRecord> DecodeBackupRecord(std::string_view bytes) {
  BackupRecord record;
  if (bytes.size() > kUint32Bytes) {
    const std::string_view content = bytes.substr(kUint32Bytes);
    if (FromLittleEndian(bytes.substr(0, kUint32Bytes)) == Crc32c(content) &&
        record.ParseFromArray(content.data(), static_cast<int>(content.size()))) {
      return record;
    }
  }
  return absl::DataLossError("its record is damaged, or of another program");
}

absl::StatusOr<std::unique_ptr<rocksdb::BackupEngine>> OpenToWrite(const std::string& directory,
                                                                   std::int64_t bytes_per_second,
                                                                   rocksdb::Env* database_env) {
  rocksdb::BackupEngineOptions options = MakeOptions(directory);
  options.backup_env = rocksdb::Env::Default();
  options.backup_rate_limit = static_cast<std::uint64_t>(bytes_per_second);
  rocksdb::BackupEngine* engine = nullptr;
  const rocksdb::Status opened = rocksdb::BackupEngine::Open(options, database_env, &engine);
  if (!opened.ok()) return FromBackupEngine(opened, "read the backups", directory);
  return std::unique_ptr<rocksdb::BackupEngine>(engine);
}

absl::Status DeleteUnfinished(rocksdb::BackupEngine& engine, const std::string& directory) {
  std::vector<rocksdb::BackupInfo> intact;
  engine.GetBackupInfo(&intact);
  std::vector<rocksdb::BackupID> ids;
  engine.GetCorruptedBackups(&ids);
  for (const rocksdb::BackupInfo& info : intact) ids.push_back(info.backup_id);
  BackupId last = 0;
  for (const rocksdb::BackupID id : ids) last = std::max(last, id);
  // RocksDB's condition. Without it files of damaged backups would be deleted at each backup.
  std::error_code unknown;
  if (!std::filesystem::exists(directory + "/private/" + std::to_string(last + 1), unknown)) {
    return absl::OkStatus();
  }
  return FromBackupEngine(engine.GarbageCollect(), "make a backup", directory);
}

absl::StatusOr<std::unique_ptr<rocksdb::BackupEngineReadOnly>> OpenToRead(
    const std::string& directory, rocksdb::Env* env) {
  RETURN_IF_ERROR(CheckFoldersReadable(directory));
  rocksdb::BackupEngineOptions options = MakeOptions(directory);
  options.backup_env = env;
  rocksdb::BackupEngineReadOnly* engine = nullptr;
  const rocksdb::Status opened =
      rocksdb::BackupEngineReadOnly::Open(options, rocksdb::Env::Default(), &engine);
  if (opened.IsNotFound() || opened.IsPathNotFound()) {
    return absl::NotFoundError("there are no backups in " + directory +
                               "; give the folder of a server's --backup-dir");
  }
  if (!opened.ok()) return FromBackupEngine(opened, "read the backups", directory);
  return std::unique_ptr<rocksdb::BackupEngineReadOnly>(engine);
}

absl::Status FromBackupEngine(const rocksdb::Status& status, const std::string& action,
                              const std::string& directory) {
  if (status.ok()) return absl::OkStatus();
  const std::string what = "cannot " + action + " in " + directory + ": " + status.ToString();
  if (status.IsNoSpace()) {
    return absl::ResourceExhaustedError(what + "; free space on that disk, or delete backups");
  }
  if (status.IsCorruption()) return absl::DataLossError(what);
  return absl::UnavailableError(what + "; check the disk and the permissions of the folder");
}

absl::Status CannotReadFolder(const std::string& directory, const std::error_code& error) {
  return absl::UnavailableError("the folder " + directory + " cannot be read (" + error.message() +
                                "); check its permissions");
}

absl::Status DamagedBackup(BackupId id, const std::string& directory, std::string_view reason) {
  return absl::DataLossError("backup " + std::to_string(id) + " in " + directory + " is damaged (" +
                             std::string(reason) +
                             "); use another one and delete it: graspdb backup list");
}

absl::Status NoBackup(BackupId id, const std::string& directory) {
  return absl::NotFoundError("there is no backup " + std::to_string(id) + " in " + directory +
                             "; the existing ones: graspdb backup list");
}

absl::StatusOr<rocksdb::BackupInfo> FindBackup(const rocksdb::BackupEngineReadOnlyBase& engine,
                                               BackupId id, const std::string& directory) {
  rocksdb::BackupInfo info;
  const rocksdb::Status found = engine.GetBackupInfo(id, &info, /*include_file_details=*/true);
  if (found.IsCorruption()) return DamagedBackup(id, directory, found.ToString());
  if (!found.ok()) return NoBackup(id, directory);
  if (const auto record = DecodeBackupRecord(info.app_metadata); !record.ok()) {
    return DamagedBackup(id, directory, std::string(record.status().message()));
  }
  return info;
}

Backup DescribeBackup(const rocksdb::BackupInfo& info, const std::string& directory) {
  Backup backup;
  backup.id = info.backup_id;
  auto record = DecodeBackupRecord(info.app_metadata);
  if (!record.ok()) {
    backup.state = DamagedBackup(backup.id, directory, std::string(record.status().message()));
    return backup;
  }
  backup.record = *std::move(record);
  backup.byte_count = static_cast<std::int64_t>(info.size);
  return backup;
}

}  // namespace graspdb::storage
