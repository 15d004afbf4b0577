// Deletes old bulk uploads.
#pragma once

#include <chrono>
#include <optional>

#include "absl/time/time.h"
#include "storage/uploads.h"

namespace graspdb::server {

// Not thread-safe.
class UploadExpiry {
 public:
  using Clock = std::chrono::steady_clock;

  // Deletes the uploads that are older than the contract keeps them, and logs those that were not
  // committed. Does nothing for an hour after the last time. `wall` and `monotonic` are the times
  // of now. Where the wall clock was set ahead after the first call, only the time that really
  // passed makes uploads older.
  void Run(storage::Uploads& uploads, absl::Time wall, Clock::time_point monotonic);

 private:
  std::optional<Clock::time_point> last_;
  absl::Time now_;  // at `last_`
};

}  // namespace graspdb::server
