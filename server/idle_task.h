// Work that waits until the catalogue is idle.
#pragma once

#include <functional>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "server/live_catalogue.h"

namespace graspdb::server {

// A thread of low priority (LowerPriority) that runs `start`, and then `task` every 10 s in which
// the catalogue has not changed. Before `task` it calls CatchUp() on the live catalogue.
class IdleTask {
 public:
  // `live` must outlive this, and the functions must not throw.
  IdleTask(LiveCatalogue& live, std::function<void()> start, std::function<void()> task);
  // Waits for the running function.
  ~IdleTask();
  IdleTask(const IdleTask&) = delete;
  IdleTask& operator=(const IdleTask&) = delete;

 private:
  bool Stopped(absl::Duration wait) ABSL_LOCKS_EXCLUDED(mutex_);

  absl::Mutex mutex_;
  bool stop_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace graspdb::server
