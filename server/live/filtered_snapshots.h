// Snapshots of the catalogue without the objects that a cell does not meet.
#pragma once

#include <cstddef>
#include <list>
#include <memory>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "recognition/index/catalogue_snapshot.h"
#include "server/live/release_gates.h"

namespace graspdb::server {

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
