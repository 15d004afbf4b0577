// The RocksDB database below the catalogue: opening, reading, scanning, durable
// writing. Internal to storage/, which encapsulates RocksDB.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "rocksdb/db.h"
#include "rocksdb/iterator.h"
#include "rocksdb/snapshot.h"
#include "rocksdb/write_batch.h"
#include "storage/database/database_directory.h"
#include "storage/database/database_status.h"
#include "storage/database/disk_reserve.h"
#include "storage/database/family.h"

namespace graspdb::storage {

// Called with one row; false ends the scan, an error ends it with that error.
using RowVisitor =
    absl::FunctionRef<absl::StatusOr<bool>(std::string_view key, std::string_view value)>;

enum class WritePurpose {
  kAdd,
  kFree,  // deletes, or has to be written so that the database can be used
};

// Owns the open database and its lock. Thread-safe, except for
// CreateMissingFamilies().
class Database {
 public:
  struct Options {
    bool create_if_missing = true;
    std::size_t write_buffer_bytes = 16U << 20;
    rocksdb::Env* env = nullptr;  // not owned; null: the default one
    // Space that is kept for what frees space; see storage/database/disk_reserve.h.
    std::uint64_t reserve_bytes = 0;
  };

  // A point in time; released with the pointer, which must not outlive the database.
  using Snapshot = std::shared_ptr<const rocksdb::Snapshot>;

  // Opens the database in `directory` and takes its lock; creates an empty one if there
  // is none. Opens only existing families.
  static absl::StatusOr<std::unique_ptr<Database>> Open(const std::string& directory,
                                                        const Options& options);
  // Opens an existing database for reading, without a lock and without changing a file.
  // `directory` is read through `env` (not owned; null: the default one). The database must not
  // change meanwhile: files that another process deletes are reported as damage.
  static absl::StatusOr<std::unique_ptr<Database>> OpenReadOnly(const std::string& directory,
                                                                rocksdb::Env* env);
  ~Database();
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  const std::string& directory() const { return directory_; }
  // Whether nothing was ever written.
  bool IsPristine() const;
  bool HasAllFamilies() const;
  bool HasFamily(Family family) const;
  // Creates the missing families. To be called before other threads use the database.
  absl::Status CreateMissingFamilies();

  // The value of `key`; NOT_FOUND without one. With a snapshot, as it was then.
  absl::StatusOr<std::string> Get(Family family, std::string_view key,
                                  const rocksdb::Snapshot* snapshot = nullptr) const;
  // Whether `key` exists.
  absl::StatusOr<bool> Contains(Family family, std::string_view key) const;
  // Visits the rows whose keys begin with `prefix` and are greater than `after` (empty:
  // all of them), in ascending order of the keys.
  absl::Status Scan(Family family, std::string_view prefix, std::string_view after,
                    RowVisitor visit, const rocksdb::Snapshot* snapshot = nullptr) const;
  // The greatest key of a family; empty when there is none.
  absl::StatusOr<std::string> LastKey(Family family) const;
  Snapshot TakeSnapshot() const;
  // All rows of a family in ascending order of the keys, at the first one. Must not outlive the
  // database or the snapshot.
  std::unique_ptr<rocksdb::Iterator> Rows(Family family, const rocksdb::Snapshot* snapshot) const;

  // Adds to a batch.
  absl::Status Put(Family family, std::string_view key, std::string_view value,
                   rocksdb::WriteBatch& batch) const;
  absl::Status Delete(Family family, std::string_view key, rocksdb::WriteBatch& batch) const;
  // Deletes all keys with this prefix, which is not empty.
  absl::Status DeletePrefix(Family family, std::string_view prefix,
                            rocksdb::WriteBatch& batch) const;
  // Writes all of `batch` or nothing; when it returns, the batch is on the disk.
  // RESOURCE_EXHAUSTED when the disk is full, UNAVAILABLE when it fails: nothing was written,
  // unless the process ends before the next write succeeds. Writes succeed once the fault is gone:
  // Recover() is part of them.
  // With a reserve, RESOURCE_EXHAUSTED already when only the reserve is left, except for what frees
  // space.
  absl::Status Write(rocksdb::WriteBatch& batch, WritePurpose purpose = WritePurpose::kAdd)
      ABSL_LOCKS_EXCLUDED(log_mutex_);
  // Releases the reserve if a write that frees space, of `bytes`, needs it. It is part of that
  // write, but has to be called before Recover() alone.
  void PrepareToFree(std::uint64_t bytes) ABSL_LOCKS_EXCLUDED(log_mutex_);
  // After a write or flush failed: makes it possible to write again, if the fault is gone. OK
  // otherwise. Attempts wait for each other: at least a second, twice as long after each that
  // failed. RESOURCE_EXHAUSTED if there is no room, or a backup is being copied; UNAVAILABLE while
  // the disk fails. DATA_LOSS and some states of RocksDB take a restart.
  absl::Status Recover() ABSL_LOCKS_EXCLUDED(log_mutex_);
  // Looks whether writes would succeed, by a small file if none has failed, and else by Recover().
  // To be called periodically: it limits how often it writes. May compact the database, which ends
  // soon once `cancelled` is set (not owned; null: never).
  void CheckWrites(std::atomic<bool>* cancelled = nullptr)
      ABSL_LOCKS_EXCLUDED(log_mutex_, fault_mutex_);
  // As of the last write or CheckWrites().
  WriteFault write_fault() const ABSL_LOCKS_EXCLUDED(fault_mutex_);
  // Moves everything from the logs to sorted files. RESOURCE_EXHAUSTED when the disk is full;
  // succeeds once there is room.
  absl::Status Flush() ABSL_LOCKS_EXCLUDED(log_mutex_);

  // Files that are missing or shorter than they were, and those that Get() has found damaged; 20 of
  // them at most, since more are of no use. Reads the sizes of all files from the disk, which takes
  // some microseconds for each.
  std::vector<DamagedFile> DamagedFiles() const ABSL_LOCKS_EXCLUDED(fault_mutex_);

  // Why there is no reserve although the disk has room; empty if there is, or none is wanted.
  std::string reserve_error() const;

  // For backups.
  rocksdb::DB& rocks() { return *db_; }

 private:
  Database(std::string directory, const Options& options);
  std::vector<rocksdb::ColumnFamilyDescriptor> Describe(
      const std::vector<std::string>& families) const;
  // Once what it needs of the reserve is released.
  absl::Status FlushPrepared() ABSL_LOCKS_EXCLUDED(log_mutex_);
  void FlushLargeLogs() ABSL_LOCKS_EXCLUDED(log_mutex_);
  void Adopt(const std::vector<rocksdb::ColumnFamilyHandle*>& handles);
  // The start replays the logs, for which there has to be room.
  void PrepareReserve(rocksdb::DBOptions* options);
  // Takes the reserve again if there is room.
  void TakeReserve();
  // The same, also where it could not be made before.
  void MakeReserve();
  // The room that was freed, when it is needed: deleted rows take up space until a compaction.
  void CompactForRoom(std::atomic<bool>* cancelled);
  void Compact(const rocksdb::CompactRangeOptions& options);
  // RESOURCE_EXHAUSTED if additions have to leave the rest of the disk.
  absl::Status CheckRoomToAdd();
  std::uint64_t RoomForFlush() const;
  bool HasRoom(std::uint64_t bytes) const;  // also where the file system does not say
  bool IsMemtableFull() const;
  rocksdb::Status ReplaceFullMemtables() ABSL_SHARED_LOCKS_REQUIRED(log_mutex_);
  rocksdb::Status WriteToLog(rocksdb::WriteBatch& batch) ABSL_SHARED_LOCKS_REQUIRED(log_mutex_);
  rocksdb::Status RecoverLocked() ABSL_EXCLUSIVE_LOCKS_REQUIRED(log_mutex_);
  rocksdb::Status Resume() ABSL_EXCLUSIVE_LOCKS_REQUIRED(log_mutex_);
  rocksdb::Status CheckFlushesRepeatable() const;
  std::uint64_t MemtableBytes() const;
  // Whether files of the database can be made, with `bytes` of room.
  rocksdb::Status ProbeFolder(std::uint64_t bytes) const;
  // The same for a flush of all memtables, with its descriptors.
  rocksdb::Status ProbeFlush() const;
  absl::Status Failed(const rocksdb::Status& status) ABSL_LOCKS_EXCLUDED(fault_mutex_);
  void NoteDamage(const std::string& error) const ABSL_LOCKS_EXCLUDED(fault_mutex_);
  // What a write, flush or recovery has found; OK: writes succeed again.
  void SetFailure(absl::Status error) ABSL_LOCKS_EXCLUDED(fault_mutex_);
  // What was found without a write. A failure, even one from meanwhile, stays.
  void NoteFault(absl::Status error) ABSL_LOCKS_EXCLUDED(fault_mutex_);
  void SetFault(absl::Status error) ABSL_EXCLUSIVE_LOCKS_REQUIRED(fault_mutex_);
  rocksdb::ColumnFamilyHandle* Handle(Family family) const {
    return families_[static_cast<std::size_t>(family)];
  }

  std::string directory_;
  std::size_t write_buffer_bytes_;
  bool is_read_only_ = false;
  std::shared_ptr<rocksdb::Cache> block_cache_;
  DiskReserve reserve_;
  std::unique_ptr<rocksdb::DB> db_;
  std::vector<rocksdb::ColumnFamilyHandle*> handles_;  // all of them, known or not
  std::array<rocksdb::ColumnFamilyHandle*, kFamilyCount> families_{};

  FolderId folder_;  // of directory_ when it was opened

  absl::Mutex log_mutex_ ABSL_ACQUIRED_BEFORE(fault_mutex_);  // shared by writers
  // A write or flush failed. Changed with fault_mutex_ locked, together with fault_.
  std::atomic<bool> is_failing_ = false;
  std::chrono::steady_clock::time_point next_recovery_ ABSL_GUARDED_BY(log_mutex_);
  std::chrono::steady_clock::duration recovery_interval_ ABSL_GUARDED_BY(log_mutex_){};
  std::chrono::steady_clock::time_point next_probe_;  // of CheckWrites()
  rocksdb::Status probed_;                            // the last one
  std::atomic<bool> wants_compaction_ = false;        // may free the room that is missing

  absl::Mutex replacement_mutex_;  // of memtables
  mutable absl::Mutex fault_mutex_;
  WriteFault fault_ ABSL_GUARDED_BY(fault_mutex_);
  mutable std::map<std::string, std::string> damage_ ABSL_GUARDED_BY(fault_mutex_);  // by file
};

}  // namespace graspdb::storage
