// Space of the database's file system that is kept for what frees space.
#pragma once

#include <cstdint>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace graspdb::storage {

inline constexpr char kReserveFile[] = "RESERVE";

// A file in the database's folder that takes up the space, until it is released. Other programs
// may take what was released, so it is released only for a need, and taken again soon. Thread-safe.
// docs/adr/0037-a-reserve-for-what-frees-space.md
class DiskReserve {
 public:
  // At most `bytes`, and at most a sixteenth of the file system. Zero: none. Changes no file.
  DiskReserve(const std::string& directory, std::uint64_t bytes);
  DiskReserve(const DiskReserve&) = delete;
  DiskReserve& operator=(const DiskReserve&) = delete;

  std::uint64_t bytes() const { return bytes_; }
  // Whether the space is taken up. True without a reserve, and where it cannot be made.
  bool is_held() const ABSL_LOCKS_EXCLUDED(mutex_);
  // Uses the file of an earlier process, or deletes it if it has another size. To be called by the
  // owner of the database, before the other functions.
  void Adopt() ABSL_LOCKS_EXCLUDED(mutex_);
  // Frees the space; does nothing if it is free.
  void Release() ABSL_LOCKS_EXCLUDED(mutex_);
  // Why there is no reserve: errno of an attempt that failed for another reason than a full disk;
  // else 0.
  int failure() const ABSL_LOCKS_EXCLUDED(mutex_);
  // Takes up the space if there is as much of it and `beside` bytes, or tries again where it could
  // not be made. Where the file system cannot do that, there is no reserve from then on.
  void Take(std::uint64_t beside) ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  const std::string directory_;
  const std::string path_;
  std::uint64_t bytes_ = 0;
  mutable absl::Mutex mutex_;
  int failure_ ABSL_GUARDED_BY(mutex_) = 0;
  bool is_held_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace graspdb::storage
