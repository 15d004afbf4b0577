// The catalogue: objects, stable poses, views and cells on disk.
//
// Thread safety: every method may be called from any thread. Readers never wait for
// writers; writers are serialised. A reader gets one committed state of one record;
// ForEach() gives one state of all records.
//
// Durability: a mutation that returned OK is on the disk. It survives a crash of the
// process at any instruction and, if the disk flushes as requested, a crash of the
// machine. A mutation that did not return is applied as a whole or not at all. When the
// disk is full or fails, changes return RESOURCE_EXHAUSTED or UNAVAILABLE and are not
// applied (unless the process ends before changes work again, then as a whole or not at
// all). They work again once there is room or the disk works. After DATA_LOSS the
// catalogue rejects further changes until it is reopened.
//
// Revisions: every change gets the next revision, 1 first, without gaps, and leaves a
// change record in the same atomic write. No write bypasses them. Old change records are
// deleted in the write of a later change, see CatalogueOptions::keep_changes.
//
// Errors: each one is a status whose text suggests what to do next. Besides the codes
// documented at the methods, all of them can return DATA_LOSS (the database is damaged)
// and UNAVAILABLE (the disk fails). No method throws, except when out of memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "graspdb/v1/catalog.pb.h"
#include "graspdb/v1/cell.pb.h"
#include "storage/database/database_status.h"
#include "storage/records.pb.h"
#include "storage/records/record_types.h"

namespace rocksdb {
class Env;
}  // namespace rocksdb

namespace graspdb::storage {

class Backups;
class ChangeBatch;
class ChangeLog;
class Database;
class History;
class Uploads;

struct CatalogueOptions {
  // Whether to create a missing database; otherwise it is NOT_FOUND.
  bool create_if_missing = true;
  // Source of create and update times, and of backups' times. Called by one writer at a time; must
  // not throw.
  std::function<absl::Time()> clock = absl::Now;
  // Number of the newest change records that are kept; at least 1. Twice as many take twice the
  // disk: 1.5 KB per view.
  std::int64_t keep_changes = 50'000;
  // Views of all uploads that are not committed, together. Their names are in memory, up to 0.5 KB
  // each: twice as many take 100 MB more.
  std::size_t max_staged_views = 200'000;
  // Write buffer of each of the twelve families before it is flushed to a file, in bytes.
  std::size_t write_buffer_bytes = 16U << 20;
  // Space that is kept for deletions, starts and compactions (storage/database/disk_reserve.h), in
  // bytes.
  std::uint64_t disk_reserve_bytes = 0;
  // Environment for file access; not owned, must outlive the catalogue. Null: the default
  // one. Tests set a failing disk here.
  rocksdb::Env* env = nullptr;
};

struct CatalogueCounts {
  std::int64_t objects = 0;
  std::int64_t stable_poses = 0;
  std::int64_t views = 0;
  std::int64_t cells = 0;
};

// A request that its caller may send again.
struct RequestKey {
  std::string id = {};              // a UUID in lower case; empty: the request has none
  std::string content_digest = {};  // SHA-256 of the request without its id
};

// The counts of a grasp after an outcome was added, and the revision of that change.
struct AddedOutcomes {
  v1::GraspOutcomeCounts counts;
  std::int64_t revision = 0;
  bool is_repeated = false;  // the answer to an earlier request with this id; nothing changed
};

// Callbacks for the records in ForEach(); empty functions are skipped, and an error ends
// the reading. Called on the reading thread.
struct RecordVisitor {
  std::function<absl::Status(const v1::Object&)> object;
  std::function<absl::Status(const v1::StablePose&)> stable_pose;
  std::function<absl::Status(const ViewRecord&)> view;
  std::function<absl::Status(const v1::Cell&)> cell;
  std::function<absl::Status(const GraspOutcomesRecord&)> grasp_outcomes;
};

// Should not throw: the change remains, and the listener gets the next one, whose revision shows
// that it missed one.
using ChangeListener = std::function<void(const ChangeRecord&)>;

class Catalogue {
 public:
  // Opens the database in `directory`, or creates it. One process owns a database at a
  // time: FAILED_PRECONDITION for the second. FAILED_PRECONDITION also when the
  // directory has other contents or the schema is newer than this program; DATA_LOSS
  // when it is damaged. An older schema is migrated, and a database without id gets one.
  static absl::StatusOr<std::unique_ptr<Catalogue>> Open(const std::string& directory,
                                                         CatalogueOptions options = {});
  // Closes the database. No other thread may be in a method.
  ~Catalogue();
  Catalogue(const Catalogue&) = delete;
  Catalogue& operator=(const Catalogue&) = delete;

  // A UUID, random for each new or restored database. Does not change while it is open. Revisions
  // count the changes of the catalogue with this id: after a restore, other changes get the same
  // revisions.
  std::string id() const;
  // Revision of the last change; 0 before the first one.
  std::int64_t revision() const;
  // Numbers of records; kept in memory.
  CatalogueCounts counts() const;
  int schema_version() const;
  // The state of database and disk.
  DatabaseStatus database_status() const;
  // See Database::DamagedFiles().
  std::vector<DamagedFile> damaged_files() const;
  // Looks whether changes would succeed, for database_status().write_fault, and after a failed one
  // makes them succeed if the fault is gone. To be called each second by one thread. May
  // compact the database, which ends soon once `cancelled` is set (not owned; null: never).
  void CheckWrites(std::atomic<bool>* cancelled = nullptr);
  // The directory given to Open().
  const std::string& directory() const;

  // --- Objects, stable poses, cells -------------------------------------------------
  // Names are checked, INVALID_ARGUMENT; other fields are stored as they are. Etag,
  // create_time and update_time are set here; the caller's values are ignored.
  //
  // Create: ALREADY_EXISTS, or NOT_FOUND for a missing parent.
  // Get: NOT_FOUND.
  // List: at most `page_size` (at least 1) records after `after_name` (empty: from the
  //   first), fewer where they exceed 1 MiB together; NOT_FOUND for a missing parent.
  // Update: `change` edits the record, with other changes locked out; its error ends the
  //   update with nothing changed. `change` must not call the catalogue. ABORTED when
  //   `etag` is given and is not the record's.
  // Delete: ABORTED as Update. FAILED_PRECONDITION when there are children, unless
  //   `force`, which deletes them, including views, in the same change. Objects and what they had
  //   stay in the history.

  absl::StatusOr<v1::Object> CreateObject(v1::Object object);
  absl::StatusOr<v1::Object> GetObject(std::string_view name) const;
  absl::StatusOr<Page<v1::Object>> ListObjects(std::size_t page_size,
                                               std::string_view after_name) const;
  absl::StatusOr<v1::Object> UpdateObject(std::string_view name, std::string_view etag,
                                          const std::function<absl::Status(v1::Object&)>& change);
  absl::Status DeleteObject(std::string_view name, bool force, std::string_view etag);

  absl::StatusOr<v1::StablePose> CreateStablePose(v1::StablePose stable_pose);
  absl::StatusOr<v1::StablePose> GetStablePose(std::string_view name) const;
  absl::StatusOr<Page<v1::StablePose>> ListStablePoses(std::string_view object_name,
                                                       std::size_t page_size,
                                                       std::string_view after_name) const;
  absl::StatusOr<v1::StablePose> UpdateStablePose(
      std::string_view name, std::string_view etag,
      const std::function<absl::Status(v1::StablePose&)>& change);
  absl::Status DeleteStablePose(std::string_view name, bool force, std::string_view etag);

  absl::StatusOr<v1::Cell> CreateCell(v1::Cell cell);
  absl::StatusOr<v1::Cell> GetCell(std::string_view name) const;
  absl::StatusOr<Page<v1::Cell>> ListCells(std::size_t page_size,
                                           std::string_view after_name) const;
  absl::StatusOr<v1::Cell> UpdateCell(std::string_view name, std::string_view etag,
                                      const std::function<absl::Status(v1::Cell&)>& change);
  absl::Status DeleteCell(std::string_view name, std::string_view etag);

  // --- Views ------------------------------------------------------------------------

  // Stores a view. NOT_FOUND without its stable pose, INVALID_ARGUMENT without a digest
  // or a cloud, ALREADY_EXISTS when a view of that name has another digest.
  absl::StatusOr<PutViewOutcome> PutView(const NewView& view);
  // Stores views in one atomic write: each with its own revision, all or none. The
  // outcomes are in the order of `views`. The first view that cannot be stored ends
  // the call with its error, which names the view.
  absl::StatusOr<std::vector<PutViewOutcome>> PutViews(std::span<const NewView> views);
  absl::StatusOr<ViewRecord> GetView(std::string_view name) const;
  // The bytes given to PutView.
  absl::StatusOr<std::string> GetPackedCloud(std::string_view name) const;
  absl::StatusOr<Page<ViewRecord>> ListViews(std::string_view stable_pose_name,
                                             std::size_t page_size,
                                             std::string_view after_name) const;
  absl::Status DeleteView(std::string_view name);
  // Replaces descriptors after their parameters changed: one change, all or nothing.
  // Its change record contains all the views, so pass some hundreds at a time. A view that was
  // deleted or replaced by other content meanwhile is left out. Returns the revision; without
  // updates, the current one.
  absl::StatusOr<std::int64_t> ReplaceDescriptors(std::span<const DescriptorUpdate> updates);

  // --- Outcomes of grasps -----------------------------------------------------------
  // A record for each stable pose with reported outcomes. It is deleted with its stable pose, and
  // the counts of a grasp are deleted when UpdateStablePose removes the grasp or changes its tool
  // pose, opening or free turn. Stable poses and their etags do not include it.

  // Adds `added` to the counts of a grasp of that stable pose. NOT_FOUND without the stable pose or
  // the grasp, INVALID_ARGUMENT unless at least one count is positive and none is negative. A
  // request with the id of an earlier one gets its answer, or ALREADY_EXISTS if the content is
  // another; ids are known for a day, the newest 10,000 of them (storage/changes/requests.h).
  absl::StatusOr<AddedOutcomes> AddGraspOutcomes(std::string_view stable_pose_name,
                                                 const v1::GraspOutcomeCounts& added,
                                                 const RequestKey& request = {});
  // NOT_FOUND without the stable pose; no counts if there were no reports.
  absl::StatusOr<GraspOutcomesRecord> GetGraspOutcomes(std::string_view stable_pose_name) const;

  // --- Bulk uploads -----------------------------------------------------------------
  // See storage/uploads/uploads.h.
  Uploads& uploads() { return *uploads_; }

  // --- History ----------------------------------------------------------------------
  // See storage/history/history.h.
  History& history() const { return *history_; }

  // --- Following --------------------------------------------------------------------

  // Reads all records of one revision, parents before children and each kind by name,
  // and returns that revision. Reads no clouds. Does not block writers.
  absl::StatusOr<std::int64_t> ForEach(const RecordVisitor& visitor) const;

  // Sets the listener (empty: none) and returns the revision R after which it is called
  // with every change: R + 1, R + 2, ... in order, on the thread that makes the change,
  // after the change is durable and before the call that made it returns. So when a
  // write is acknowledged, the follower has applied it. To follow from the start:
  // Subscribe, then ForEach, then drop changes up to the revision of ForEach. The
  // listener blocks all writers. It may call reading methods; changes and Subscribe
  // from within it are rejected with FAILED_PRECONDITION.
  absl::StatusOr<std::int64_t> Subscribe(ChangeListener listener);
  // At most `limit` (at least 1) change records after `after_revision`, oldest first; fewer where
  // they have a MiB or more. Empty after the last one. OUT_OF_RANGE if some of them are no longer
  // kept.
  absl::StatusOr<std::vector<ChangeRecord>> ReadChanges(std::int64_t after_revision,
                                                        std::size_t limit) const;

 private:
  friend class Backups;

  Catalogue(std::unique_ptr<Database> database, std::unique_ptr<ChangeLog> log,
            std::size_t max_staged_views);

  std::unique_ptr<Database> database_;
  std::unique_ptr<ChangeLog> log_;
  std::unique_ptr<Uploads> uploads_;
  std::unique_ptr<History> history_;
};

}  // namespace graspdb::storage
