// The RocksDB database below the catalogue: opening, reading, scanning, durable
// writing. Internal to storage/, which encapsulates RocksDB.
#pragma once

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
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
#include "storage/family.h"

namespace graspdb::storage {

// Called with one row; false ends the scan, an error ends it with that error.
using RowVisitor =
    absl::FunctionRef<absl::StatusOr<bool>(std::string_view key, std::string_view value)>;

// Owns the open database and its lock. Thread-safe, except for
// CreateMissingFamilies().
class Database {
 public:
  struct Options {
    bool create_if_missing = true;
    std::size_t write_buffer_bytes = 16U << 20;
    rocksdb::Env* env = nullptr;  // not owned; null: the default one
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
  // RESOURCE_EXHAUSTED when the disk is full: nothing was written, unless the process ends before
  // the next write succeeds, and writes succeed once there is room; UNAVAILABLE then if not even a
  // new log could be made. After any other error it is unknown whether the batch was written, until
  // the database is opened again.
  absl::Status Write(rocksdb::WriteBatch& batch) ABSL_LOCKS_EXCLUDED(log_mutex_);
  // After a write or flush found the disk full: makes it possible to write again, if there is room.
  // OK otherwise. RESOURCE_EXHAUSTED if there is no room, or a backup is being copied.
  absl::Status RecoverFromFullDisk() ABSL_LOCKS_EXCLUDED(log_mutex_);
  // Moves everything from the logs to sorted files. RESOURCE_EXHAUSTED when the disk is full;
  // succeeds once there is room.
  absl::Status Flush() ABSL_LOCKS_EXCLUDED(log_mutex_);

  // For backups.
  rocksdb::DB& rocks() { return *db_; }

 private:
  Database(std::string directory, std::size_t write_buffer_bytes);
  std::vector<rocksdb::ColumnFamilyDescriptor> Describe(
      const std::vector<std::string>& families) const;
  void FlushLargeLogs() ABSL_LOCKS_EXCLUDED(log_mutex_);
  void Adopt(const std::vector<rocksdb::ColumnFamilyHandle*>& handles);
  rocksdb::Status WriteToLog(rocksdb::WriteBatch& batch) ABSL_SHARED_LOCKS_REQUIRED(log_mutex_);
  bool HasRoomForMemtables() const;  // also where the file system does not say
  rocksdb::Status Resume() ABSL_EXCLUSIVE_LOCKS_REQUIRED(log_mutex_);
  rocksdb::ColumnFamilyHandle* Handle(Family family) const {
    return families_[static_cast<std::size_t>(family)];
  }

  std::string directory_;
  std::size_t write_buffer_bytes_;
  std::shared_ptr<rocksdb::Cache> block_cache_;
  std::unique_ptr<rocksdb::DB> db_;
  std::vector<rocksdb::ColumnFamilyHandle*> handles_;  // all of them, known or not
  std::array<rocksdb::ColumnFamilyHandle*, kFamilyCount> families_{};

  absl::Mutex log_mutex_;  // shared by writers
  std::atomic<bool> is_full_ = false;
  std::chrono::steady_clock::time_point next_recovery_ ABSL_GUARDED_BY(log_mutex_);
};

}  // namespace graspdb::storage
