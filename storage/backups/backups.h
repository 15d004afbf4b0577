// Backups of a catalogue, in a folder of their own. docs/backup.md explains their use,
// docs/storage-format.md the folder.
//
// A backup is made while the catalogue is in use and contains exactly one revision, with every
// change that was acknowledged before. Backups share the files that have not changed between them.
// One process at a time makes and deletes backups in a folder; others may list, verify, compare and
// restore meanwhile.
//
// Errors, besides those at the functions: NOT_FOUND without the folder or the backup, DATA_LOSS for
// a damaged one (the text names the backup and the file), CANCELLED, RESOURCE_EXHAUSTED when the
// disk is full, UNAVAILABLE when it fails, ABORTED from Create(), Verify(), Delete() and
// DeleteOld() while another one of them runs.
#pragma once

#include <sys/types.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/functional/function_ref.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "storage/catalogue/catalogue.h"
#include "storage/records.pb.h"

namespace rocksdb {
class FileLock;
}  // namespace rocksdb

namespace graspdb::storage {

struct DatabaseState;

// Number of a backup in its folder: 1, 2, 3, ... When the newest one is deleted, the next one gets
// its number.
using BackupId = std::uint32_t;

struct Backup {
  BackupId id = 0;
  // DATA_LOSS if damage is visible without reading the files: one is missing.
  absl::Status state;
  // The fields below are empty for a damaged backup.
  BackupRecord record;
  // All its files, including those that it shares with other backups.
  std::int64_t byte_count = 0;
  // Of Create(): an earlier call with the request id made it.
  bool is_repeated = false;
};

// Observes a long function. The callbacks may be empty, are called on several threads, one at a
// time, and must not throw.
struct BackupProgress {
  std::function<void(std::int64_t bytes)> on_bytes;  // bytes copied or read so far
  std::function<bool()> is_cancelled;

  void Report(std::int64_t bytes) const {
    if (on_bytes) on_bytes(bytes);
  }
  bool IsCancelled() const { return is_cancelled && is_cancelled(); }
};

// Which intact backups are kept. The newest one always is.
struct BackupRetention {
  std::int64_t count = std::numeric_limits<std::int64_t>::max();
  absl::Duration max_age = absl::InfiniteDuration();
  std::set<BackupId> damaged = {};  // known to be, though no file is missing
};

// A record that a restore would change.
struct Difference {
  enum class Kind { kAdded, kChanged, kRemoved };
  Kind kind = Kind::kAdded;
  std::string name;  // of the object, stable pose, view or cell
};
using DifferenceVisitor = absl::FunctionRef<absl::Status(const Difference&)>;

// A file, whatever names it has.
struct FileId {
  dev_t device = 0;
  ino_t inode = 0;

  bool operator==(const FileId&) const = default;
};

// Thread-safe.
class Backups {
 public:
  // Accesses nothing. `bytes_per_second` limits what Create() copies; 0: no limit.
  explicit Backups(std::string directory, std::int64_t bytes_per_second = 0);
  // Ends the ownership.
  ~Backups();
  Backups(const Backups&) = delete;
  Backups& operator=(const Backups&) = delete;

  // Owns the folder, if it does not yet, until the destructor; where another folder has its name
  // since, as after another disk was mounted, that one in its place. UNAVAILABLE if the folder does
  // not exist: it is not made, so that nothing is stored below a mount point whose disk is missing.
  // FAILED_PRECONDITION if another process owns it or it has other files.
  absl::Status Claim();

  // Claims the folder and makes a backup. Changes of the catalogue wait some milliseconds; memory
  // 10 MiB. Reads and writes the files that no backup has yet. Cancelled at most one portion of
  // copying (10 MiB) later; nothing of an unfinished backup stays. With the `request_id` of an
  // intact backup, returns that one.
  absl::StatusOr<Backup> Create(Catalogue& catalogue, const BackupProgress& progress = {},
                                std::string_view request_id = "");
  // By ascending number, damaged ones included.
  absl::StatusOr<std::vector<Backup>> List() const;
  // For each of these files of the database, such as 000012.blob, the newest backup of the
  // catalogue with this id that has it, is not visibly damaged and not in `left_out`. Files that no
  // backup has are left out.
  absl::StatusOr<std::map<std::string, BackupId>> FindFiles(
      const std::string& catalog_id, const std::vector<std::string>& names,
      const std::set<BackupId>& left_out) const;
  // Reads every byte of the backup and compares the checksums; then reads its revision from it.
  absl::StatusOr<Backup> Verify(BackupId id, const BackupProgress& progress = {}) const;
  // Claims the folder. Files that other backups share stay.
  absl::Status Delete(BackupId id);
  // Deletes the intact backups that are not to be kept and returns them.
  absl::StatusOr<std::vector<BackupId>> DeleteOld(const BackupRetention& retention, absl::Time now);
  // Writes the backup to `database`, a missing or empty directory (FAILED_PRECONDITION otherwise).
  // Works in a folder beside it, which gets that name when all is on the disk: whenever the process
  // ends, `database` is complete or not there. Checks every byte. The database gets a new
  // Catalogue::id(). FAILED_PRECONDITION also if the backup is of a newer program.
  absl::StatusOr<Backup> Restore(BackupId id, const std::string& database,
                                 const BackupProgress& progress = {}) const;
  // Visits the records that a restore would change, by kind and name, and returns the backup. Reads
  // no clouds; memory does not grow with the catalogue. An error of `visit` ends it.
  absl::StatusOr<Backup> Compare(BackupId id, const Catalogue& catalogue,
                                 const BackupProgress& progress, DifferenceVisitor visit) const;
  // The same for a database that no process has open, FAILED_PRECONDITION otherwise.
  absl::StatusOr<Backup> Compare(BackupId id, const std::string& database,
                                 const BackupProgress& progress, DifferenceVisitor visit) const;

 private:
  absl::StatusOr<Backup> CompareWith(const DatabaseState& there, BackupId id,
                                     const BackupProgress& progress, DifferenceVisitor visit) const;
  // The intact backup of that request, if any.
  absl::StatusOr<std::optional<Backup>> FindMade(std::string_view request_id) const;
  absl::StatusOr<std::vector<Backup>> ListLocked() const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(listing_mutex_);
  absl::Status DeleteLocked(const std::vector<BackupId>& ids)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(listing_mutex_);

  const std::string directory_;
  const std::int64_t bytes_per_second_;

  absl::Mutex claim_mutex_;
  rocksdb::FileLock* lock_ ABSL_GUARDED_BY(claim_mutex_) = nullptr;
  FileId lock_file_ ABSL_GUARDED_BY(claim_mutex_);  // that of lock_
  // Whether one of Create(), Verify(), Delete() and DeleteOld() runs.
  mutable std::atomic<bool> running_ = false;
  // Held while the folder is listed, and while backups are deleted.
  mutable absl::Mutex listing_mutex_;
};

}  // namespace graspdb::storage
