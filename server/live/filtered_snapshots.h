// Snapshots of the catalogue without the objects that a cell does not meet.
#pragma once

#include <cstddef>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "recognition/index/catalogue_snapshot.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// What the cell of a request admits.
struct Visibility {
  bool include_drafts = false;
  std::set<std::string> labels = {};  // objects with one of these; empty: all objects
  bool operator==(const Visibility&) const = default;
};

// Release states and labels of all objects and stable poses. Immutable.
class ReleaseGates {
 public:
  // Of all records that `add_to` visits; it outlives the visitor.
  static void AddTo(storage::RecordVisitor* visitor, ReleaseGates* gates);

  // `gates` after a change: the same pointer if the change concerns none of them. An unreadable
  // record is a draft.
  static std::shared_ptr<const ReleaseGates> After(const std::shared_ptr<const ReleaseGates>& gates,
                                                   const storage::ChangeRecord& change);

  bool ShowsAll(const Visibility& visibility) const;
  // The names are of an object and one of its stable poses.
  bool Shows(const std::string& object, const std::string& stable_pose,
             const Visibility& visibility) const;

 private:
  struct Object {
    bool draft = false;
    std::vector<std::string> labels = {};
    bool operator==(const Object&) const = default;
  };

  void SetObject(const std::string& name, Object object);
  void SetStablePose(const std::string& name, bool draft);
  static Object GateOf(const v1::Object& record);

  std::map<std::string, Object> objects_;  // drafts, and those with labels
  std::set<std::string> draft_objects_;
  std::set<std::string> draft_poses_;
};

// A snapshot of the catalogue with the release states and labels of the same revision.
struct LiveSnapshot : recognition::CatalogueSnapshot {
  std::shared_ptr<const ReleaseGates> gates;
};

// Filters snapshots, and keeps what they share with the next ones. Thread-safe.
class FilteredSnapshots {
 public:
  // `base` as a request of that visibility meets it: with the index and stable poses that the
  // catalogue would have without the others. Linear in the stable poses for a new revision, and in
  // the views of the chunks that are new in the index; else a look-up. Searches are exact unless
  // nothing is hidden.
  std::shared_ptr<const recognition::CatalogueSnapshot> Get(
      const std::shared_ptr<const LiveSnapshot>& base, const Visibility& visibility)
      ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  struct Filter;

  std::shared_ptr<Filter> FilterOf(const Visibility& visibility) ABSL_LOCKS_EXCLUDED(mutex_);
  void Bound(std::size_t base_view_count) ABSL_LOCKS_EXCLUDED(mutex_);

  absl::Mutex mutex_;
  std::list<std::shared_ptr<Filter>> filters_ ABSL_GUARDED_BY(mutex_);  // the last used in front
};

}  // namespace graspdb::server
