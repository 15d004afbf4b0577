// Stores requests of robots and their answers, without blocking the robots.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/blackbox/bundle_files.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

struct BlackBoxOptions {
  BundleRingOptions ring;
  // Capacity of the write queue, in bundles; more are dropped. A Kinect v2 frame is half a
  // megabyte.
  std::size_t max_waiting = 32;
};

// Counters since the start.
struct BlackBoxCounts {
  std::int64_t kept = 0;     // written
  std::int64_t dropped = 0;  // the disk was too slow
  std::int64_t failed = 0;   // write errors, each logged once per reason
};

// Whether a request failed: an error, a response that is not OK, or one whose best detection scores
// less than `low_score` (0 to 1).
bool IsTroubled(const v1::Bundle& bundle, double low_score);

// Writes bundles on a thread of its own. Thread-safe.
class BlackBox {
 public:
  // Errors as BundleRing::Open; RESOURCE_EXHAUSTED when no thread is left.
  static absl::StatusOr<std::unique_ptr<BlackBox>> Open(const BlackBoxOptions& options);
  // Writes the queued bundles.
  ~BlackBox();
  BlackBox(const BlackBox&) = delete;
  BlackBox& operator=(const BlackBox&) = delete;

  // Queues a bundle without waiting for the disk. False if it was dropped.
  bool Keep(v1::Bundle bundle) ABSL_LOCKS_EXCLUDED(mutex_);

  // Waits until all bundles so far are written or have failed. For tests only.
  void Flush() ABSL_LOCKS_EXCLUDED(mutex_);

  BlackBoxCounts counts() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  BlackBox(BundleRing ring, std::size_t max_waiting);
  void WriteAll() ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status Write(const v1::Bundle& bundle);

  BundleRing ring_;  // of the thread
  const std::size_t max_waiting_;
  mutable absl::Mutex mutex_;
  absl::CondVar changed_;
  std::deque<v1::Bundle> waiting_ ABSL_GUARDED_BY(mutex_);
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool stop_ ABSL_GUARDED_BY(mutex_) = false;
  BlackBoxCounts counts_ ABSL_GUARDED_BY(mutex_);
  std::thread thread_;
};

}  // namespace graspdb::client
