// Backups of the served catalogue: logged, cancelled at shutdown, with a state for status requests.
#pragma once

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graspdb/v1/backup.pb.h"
#include "server/base/options.h"
#include "storage/backups/backups.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Thread-safe. Errors as those of storage::Backups.
class CatalogueBackups {
 public:
  // Claims the folder of the options. FAILED_PRECONDITION if it cannot be used as it is: of another
  // process, with other files, or one of folder and database within the other. If its disk fails,
  // this is logged, and later operations try again. `catalogue` must outlive the result.
  static absl::StatusOr<std::unique_ptr<CatalogueBackups>> Open(const ServerOptions& options,
                                                                storage::Catalogue& catalogue);

  absl::StatusOr<storage::Backup> Create(const storage::BackupProgress& progress,
                                         std::string_view request_id = "");
  absl::StatusOr<storage::Backup> Verify(storage::BackupId id,
                                         const storage::BackupProgress& progress);
  absl::Status Delete(storage::BackupId id);
  absl::Status DeleteOld(const storage::BackupRetention& retention, absl::Time now);
  // With the damage that is visible, and what Verify() found since the start.
  absl::StatusOr<std::vector<storage::Backup>> List();
  // For each of these files of the database, such as 000012.blob, the newest backup that has it and
  // is not known to be damaged. Reads the folder.
  std::map<std::string, storage::BackupId> NewestWith(const std::vector<std::string>& files) const
      ABSL_LOCKS_EXCLUDED(mutex_);
  // What a restore would change in the catalogue.
  absl::StatusOr<storage::Backup> Compare(storage::BackupId id,
                                          const storage::BackupProgress& progress,
                                          storage::DifferenceVisitor visit) const;

  // Cancels running operations and all later ones, and returns at once.
  void Stop() { stopped_ = true; }

  // In memory; never waits for a disk.
  v1::BackupStatus Status() const ABSL_LOCKS_EXCLUDED(mutex_);
  // When the newest good backup was begun.
  std::optional<absl::Time> LastGoodTime() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  CatalogueBackups(const ServerOptions& options, storage::Catalogue& catalogue);
  // While a backup is known to be damaged: reads a new one, which may share its files, and deletes
  // it unless it is intact.
  absl::Status CheckSharedFiles(storage::BackupId id, const storage::BackupProgress& progress)
      ABSL_LOCKS_EXCLUDED(mutex_);
  storage::BackupProgress UntilStop(const storage::BackupProgress& progress) const;
  void Refresh() ABSL_LOCKS_EXCLUDED(mutex_);
  void ReadDisk() ABSL_LOCKS_EXCLUDED(mutex_);
  // Remembers whether the backup is damaged, where `status` is an answer to that.
  void NoteVerified(storage::BackupId id, const absl::Status& status) ABSL_LOCKS_EXCLUDED(mutex_);
  void NoteFailure(const absl::Status& status, std::string_view action) ABSL_LOCKS_EXCLUDED(mutex_);

  const double interval_s_;
  const std::filesystem::path folder_;
  storage::Catalogue& catalogue_;
  storage::Backups backups_;
  std::atomic<bool> stopped_ = false;

  mutable absl::Mutex mutex_;
  int count_ ABSL_GUARDED_BY(mutex_) = 0;
  std::optional<std::filesystem::space_info> disk_ ABSL_GUARDED_BY(mutex_);  // of the last use
  std::optional<storage::Backup> last_good_ ABSL_GUARDED_BY(mutex_);
  // What Verify() found.
  std::map<storage::BackupId, absl::Status> damaged_ ABSL_GUARDED_BY(mutex_);
  std::string last_error_ ABSL_GUARDED_BY(mutex_);
  absl::Time last_error_time_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
