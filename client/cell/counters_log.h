// Counters in the log, from time to time.
#pragma once

#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/counters.h"

namespace graspdb::client {

// Logs `counters` every `period`, and once more at its end.
class CountersLog {
 public:
  // `counters` must outlive this.
  CountersLog(const Counters& counters, absl::Duration period);
  ~CountersLog();
  CountersLog(const CountersLog&) = delete;
  CountersLog& operator=(const CountersLog&) = delete;

 private:
  void Run();

  const Counters& counters_;
  const absl::Duration period_;
  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace graspdb::client
