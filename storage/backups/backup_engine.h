// RocksDB's BackupEngine with our errors. Internal to storage/.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <system_error>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "rocksdb/utilities/backup_engine.h"
#include "storage/backups/backups.h"
#include "storage/records.pb.h"

namespace graspdb::storage {

// A CRC-32C of the record, 4 bytes, little-endian, and the record.
std::string EncodeBackupRecord(const BackupRecord& record);

// DATA_LOSS if the bytes are damaged or of another program.
absl::StatusOr<BackupRecord> DecodeBackupRecord(std::string_view bytes);

// Bytes between two calls of CreateBackupOptions::progress_callback, where a backup is cancelled. A
// disk that is shared with others writes them in some milliseconds; a call takes less than 1 us.
inline constexpr std::int64_t kBackupProgressBytes = 16 << 10;

// An engine that makes and deletes backups of a database in `database_env`.
absl::StatusOr<std::unique_ptr<rocksdb::BackupEngine>> OpenToWrite(const std::string& directory,
                                                                   std::int64_t bytes_per_second,
                                                                   rocksdb::Env* database_env);

// Deletes what a backup that did not end has left, if the next one would do so while it holds
// changes. Linear in the files of the folder then.
absl::Status DeleteUnfinished(rocksdb::BackupEngine& engine, const std::string& directory);

// An engine that reads backups through `env`, which must outlive it (null: the default one).
// NOT_FOUND if the folder has no backups, UNAVAILABLE if it or one of its folders cannot be read.
absl::StatusOr<std::unique_ptr<rocksdb::BackupEngineReadOnly>> OpenToRead(
    const std::string& directory, rocksdb::Env* env);

// The status of an operation on the folder. `action` describes it, e.g. "delete backup 3".
absl::Status FromBackupEngine(const rocksdb::Status& status, const std::string& action,
                              const std::string& directory);

// UNAVAILABLE with the reason and advice.
absl::Status CannotReadFolder(const std::string& directory, const std::error_code& error);

// DATA_LOSS that names the backup.
absl::Status DamagedBackup(BackupId id, const std::string& directory, std::string_view reason);

// NOT_FOUND.
absl::Status NoBackup(BackupId id, const std::string& directory);

// A backup of an engine. NOT_FOUND, or DATA_LOSS if it is visibly damaged.
absl::StatusOr<rocksdb::BackupInfo> FindBackup(const rocksdb::BackupEngineReadOnlyBase& engine,
                                               BackupId id, const std::string& directory);

// The same as our type, with its state.
Backup DescribeBackup(const rocksdb::BackupInfo& info, const std::string& directory);

}  // namespace graspdb::storage
