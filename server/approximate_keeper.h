// Keeps the approximate index of a catalogue, and the file beside the database that it survives a
// restart in; docs/adr/0020-an-approximate-index-proposes-and-chi-square-ranks.md.
#pragma once

#include <cstddef>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "recognition/parameters.h"
#include "server/live_catalogue.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Loads the file or makes the index when it is constructed, 10 s for a million views, and makes it
// again on a thread of its own when a fifth of its views have come or gone and nothing has changed
// for a while. Requests do not wait for that: newer views are searched exactly.
class ApproximateKeeper {
 public:
  // The references must outlive this.
  ApproximateKeeper(const storage::Catalogue& catalogue, LiveCatalogue& live,
                    const recognition::DescriptorParameters& parameters);
  ~ApproximateKeeper();
  ApproximateKeeper(const ApproximateKeeper&) = delete;
  ApproximateKeeper& operator=(const ApproximateKeeper&) = delete;

  // Makes the index again where it is outdated. One at a time.
  void RebuildIfOutdated();

 private:
  absl::Status Load();
  absl::Status Write(const recognition::ApproximateIndex& index);
  void Rebuild();
  void Watch();
  bool Stopped(absl::Duration wait) ABSL_LOCKS_EXCLUDED(mutex_);

  const storage::Catalogue& catalogue_;
  LiveCatalogue& live_;
  const recognition::DescriptorParameters parameters_;
  std::size_t tried_ = 0;  // views at the last try
  bool on_file_ = false;   // the index that was made or loaded last
  absl::Mutex mutex_;
  bool stop_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace graspdb::server
