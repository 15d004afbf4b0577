// Deletes what is kept for a set time: old bulk uploads, deleted objects and the history of
// objects.
#pragma once

#include <chrono>
#include <optional>

#include "absl/time/time.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Not thread-safe.
class Expiry {
 public:
  using Clock = std::chrono::steady_clock;

  // Deleted objects, and the values before changes, are kept for `history_kept`.
  explicit Expiry(absl::Duration history_kept) : history_kept_(history_kept) {}

  absl::Duration history_kept() const { return history_kept_; }

  // Deletes the uploads that are older than the contract keeps them, and history that is older than
  // it is kept; logs uploads that were not committed, and objects. Does nothing for an hour after
  // the last time. `wall` and `monotonic` are the times of now. Where the wall clock was set ahead
  // after the first call, only the time that really passed since then makes them older; where it
  // was set back, nothing more is deleted until it is right again. A clock that is ahead at the
  // first call must not purge all of the history either: where it makes the last change older than
  // history is kept, by more than a week, time begins at that change.
  void Run(storage::Catalogue& catalogue, absl::Time wall, Clock::time_point monotonic);

 private:
  absl::Time TimeAtStart(const storage::Catalogue& catalogue, absl::Time wall) const;
  void DeleteUploads(storage::Catalogue& catalogue) const;
  void PurgeHistory(storage::Catalogue& catalogue) const;

  // The first call.
  struct Start {
    absl::Time wall;
    Clock::time_point monotonic;
  };

  const absl::Duration history_kept_;
  std::optional<Start> start_;
  Clock::time_point last_;  // after the start
  absl::Time now_;          // at `last_`
};

}  // namespace graspdb::server
