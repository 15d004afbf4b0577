// Deleted objects and earlier revisions of objects.
//
// Every change of an object, its stable poses and views stores the values before it in the same
// atomic write, and a view that is deleted or replaced leaves its cloud. Values and clouds are
// deleted by PurgeOlderThan() and Purge(), which are no changes of the catalogue: no reader of it
// has them. docs/adr/0030-deleted-and-changed-records-are-kept-as-history.md.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/catalog.pb.h"
#include "storage/records.pb.h"
#include "storage/records/record_types.h"

namespace graspdb::storage {

class ChangeBatch;
class ChangeLog;
class Database;

// Thread-safe. Errors of the disk as in Catalogue.
class History {
 public:
  // Both must outlive this.
  History(Database& database, ChangeLog& log) : database_(database), log_(log) {}

  // Deleted objects by name. An object that is created again is no deleted one.
  absl::StatusOr<Page<DeletedObjectRecord>> ListDeleted(std::size_t page_size,
                                                        std::string_view after_name) const;
  // NOT_FOUND.
  absl::StatusOr<DeletedObjectRecord> GetDeleted(std::string_view name) const;

  // Changes of an object, the newest first, each with its first part: at most some 64 KiB of
  // values. Only those before `before_revision` (0: all). NOT_FOUND if there is no such object and
  // nothing is known of it.
  absl::StatusOr<Page<HistoryRecord>> List(std::string_view object_name, std::size_t page_size,
                                           std::int64_t before_revision) const;

  // Brings a deleted object back as it was, with its stable poses, views and outcomes, in one
  // change. NOT_FOUND without a deleted object.
  absl::StatusOr<v1::Object> Undelete(std::string_view name);
  // Puts an object with its stable poses and views back to their state after `revision`, in one
  // change, or none if there is no difference. Outcomes come back with deleted stable poses; those
  // of changed grasps are deleted. Views have the descriptors that they had. OUT_OF_RANGE for a
  // revision that is newer than the catalogue or no longer kept, NOT_FOUND when there was no such
  // object, ABORTED as Catalogue::UpdateObject(). Has the earlier records in memory, 2 KB a view,
  // some times.
  absl::StatusOr<v1::Object> Restore(std::string_view name, std::int64_t revision,
                                     std::string_view etag);

  // Deletes a deleted object and its history for good. NOT_FOUND without one.
  absl::Status Purge(std::string_view name);
  // Deletes the values before changes that were made before `limit`, with the clouds that nothing
  // else uses, in one write for each object. A change that is older by its time than one before it,
  // since the clock was wrong, is kept as long as that one. Returns the names of the deleted
  // objects among them, which cannot be undeleted any more.
  absl::StatusOr<std::vector<std::string>> PurgeOlderThan(absl::Time limit);

 private:
  absl::StatusOr<v1::Object> RestoreIn(std::string_view name, std::int64_t revision,
                                       ChangeBatch& batch);

  Database& database_;
  ChangeLog& log_;
};

}  // namespace graspdb::storage
