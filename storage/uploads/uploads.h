// Bulk uploads: views that are stored one by one, and become part of the catalogue together.
//
// The views of an upload are durable as soon as they are staged, and no reader of the catalogue
// gets them before Commit(). Staging is no change of the catalogue: it has no revision and no
// change record. docs/adr/0029-bulk-uploads-are-staged-in-the-database.md.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "storage/records.pb.h"
#include "storage/records/record_types.h"

namespace graspdb::storage {

class ChangeLog;
class Database;

// Limit of uploads that are not committed.
inline constexpr std::size_t kMaxOpenUploads = 64;
// Views of one upload. Commit() has all their records, about 2 KB each, in memory, twice.
inline constexpr std::size_t kMaxStagedViews = 100'000;

struct StagedCounts {
  std::int64_t views = 0;
  std::int64_t errors = 0;  // views that cannot be taught
};

// A view of an upload in lists.
struct StagedItem {
  std::string view_name;
  absl::Status error;  // OK for a view that can be taught

  const std::string& name() const { return view_name; }
};

// Thread-safe. Errors of the disk as in Catalogue.
class Uploads {
 public:
  // Both must outlive this. `max_staged_views` is of all open uploads together.
  Uploads(Database& database, ChangeLog& log, std::size_t max_staged_views)
      : database_(database), log_(log), max_staged_views_(max_staged_views) {}

  // Creates an upload. The fields name, replace and expected_view_count of `wanted` are used.
  // ALREADY_EXISTS; RESOURCE_EXHAUSTED with kMaxOpenUploads.
  absl::StatusOr<UploadRecord> Create(const UploadRecord& wanted, absl::Time now);
  // NOT_FOUND.
  absl::StatusOr<UploadRecord> Get(std::string_view name) const;
  absl::StatusOr<Page<UploadRecord>> List(std::size_t page_size, std::string_view after_name) const;
  // Of an upload that is not committed; of a committed one zero. The first call after the start is
  // linear in its views.
  absl::StatusOr<StagedCounts> CountsOf(const UploadRecord& upload);
  // The views of an upload that is not committed, by name.
  absl::StatusOr<Page<StagedItem>> ListItems(const UploadRecord& upload, std::size_t page_size,
                                             std::string_view after_name) const;
  // Visits the staged views of an upload, by name, without those that cannot be taught. An error of
  // `visit` ends it and is returned. In the order of 5 us for each view.
  absl::Status ForEachView(const UploadRecord& upload,
                           const std::function<absl::Status(const ViewRecord&)>& visit) const;
  // A staged view with its cloud; NOT_FOUND also for one that cannot be taught.
  absl::StatusOr<NewView> GetStaged(const UploadRecord& upload, std::string_view view_name) const;

  // An upload that can get views. NOT_FOUND; FAILED_PRECONDITION for a committed upload. Reads no
  // disk but for the first time.
  absl::StatusOr<UploadRecord> GetOpen(std::string_view name);

  // The functions below take an upload of GetOpen(): ABORTED if it was deleted and another one has
  // its name.

  // Stores a view durably; concurrent calls share a write to the disk. A view that was staged with
  // the same content is kExisting, with other content ALREADY_EXISTS. NOT_FOUND for a deleted
  // upload, FAILED_PRECONDITION for a committed one, RESOURCE_EXHAUSTED with kMaxStagedViews, or
  // with `max_staged_views` in all uploads. The first call after the start is linear in the views
  // of all open uploads.
  absl::StatusOr<PutViewOutcome> Stage(const UploadRecord& upload, const NewView& view);
  // Stores the reason why a view cannot be taught, unless it is staged. Staging it later replaces
  // the reason. Errors as Stage(), but nothing is stored with kMaxStagedViews.
  absl::Status StageError(const UploadRecord& upload, std::string_view view_name,
                          const absl::Status& error);
  // Replaces the descriptors of staged views durably, all or none: no change of the catalogue. Pass
  // some hundreds at a time. NOT_FOUND where one is not staged; NOT_FOUND and FAILED_PRECONDITION
  // for the upload as Stage().
  absl::Status ReplaceDescriptors(const UploadRecord& upload,
                                  std::span<const DescriptorUpdate> updates);
  // The digest of a staged view, empty for one that cannot be taught; NOT_FOUND without either.
  absl::StatusOr<std::string> DigestOf(const UploadRecord& upload, std::string_view view_name);

  // FAILED_PRECONDITION as Commit() where a view cannot be taught; linear in the views only then.
  absl::Status CheckNoErrors(const UploadRecord& upload);
  // Publishes all views in one change with one revision, and returns the record with its counts.
  // `upload` is a record of Get(); a committed upload is returned as it is. NOT_FOUND if it was
  // deleted, ABORTED if another one has its name since. FAILED_PRECONDITION, with nothing changed,
  // when a view cannot be taught, its stable pose is gone, or its name is taken by other content
  // and the upload does not replace; with `skip_failed` these views are left out. Other writers
  // wait meanwhile: in the order of 10 us for each view.
  //
  // CANCELLED, with nothing changed and the upload open, where `is_cancelled` (may be null; called
  // on this thread) becomes true before the change is written: it is called each millisecond or so
  // while the change is built, but not while this waits for other writers. The write, and the
  // listener after it, always end.
  absl::StatusOr<UploadRecord> Commit(const UploadRecord& upload, bool skip_failed,
                                      const std::function<bool()>& is_cancelled = nullptr);
  // Deletes an upload with its views unless it is committed, then only its record.
  absl::Status Delete(std::string_view name);
  // Deletes the uploads that were created before `open_limit` and are not committed, and those that
  // were committed before `committed_limit`. Returns the names of the former.
  absl::StatusOr<std::vector<std::string>> DeleteOlderThan(absl::Time open_limit,
                                                           absl::Time committed_limit);

 private:
  // The views of an open upload, by name, so that each is stored once.
  struct Open;
  // The record as it is now; NOT_FOUND, ABORTED as Commit().
  absl::StatusOr<UploadRecord> GetAgain(const UploadRecord& upload) const;
  using OpenUpload = std::shared_ptr<Open>;

  absl::StatusOr<OpenUpload> OpenOf(std::string_view name) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::StatusOr<OpenUpload> OpenOf(const UploadRecord& upload) ABSL_LOCKS_EXCLUDED(mutex_);
  // Has the names of all open uploads in memory, where they are counted.
  absl::Status CountAll() ABSL_LOCKS_EXCLUDED(mutex_);
  // Counts a view that is new to the upload, whose `names` are locked. RESOURCE_EXHAUSTED.
  absl::Status CountNew(const Open& open);
  absl::Status Write(Open& open, const std::string& view_name, const StagedViewRecord& record,
                     const std::string* packed_cloud);
  // Of an upload whose `in_use` is locked. `why` is for those who wait for it.
  void End(std::string_view name, Open& open, absl::Status why) ABSL_LOCKS_EXCLUDED(mutex_);

  Database& database_;
  ChangeLog& log_;
  const std::size_t max_staged_views_;
  std::atomic<std::size_t> staged_views_ = 0;  // in memory
  std::atomic<bool> all_counted_ = false;
  absl::Mutex mutex_;
  std::map<std::string, OpenUpload, std::less<>> open_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::storage
