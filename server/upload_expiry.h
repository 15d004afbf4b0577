// Deletes old bulk uploads.
#pragma once

#include "absl/time/time.h"
#include "storage/uploads.h"

namespace graspdb::server {

// Not thread-safe.
class UploadExpiry {
 public:
  // Deletes the uploads that are older than the contract keeps them, and logs those that were not
  // committed. Does nothing for an hour after the last time.
  void Run(storage::Uploads& uploads);

 private:
  absl::Time next_ = absl::InfinitePast();
};

}  // namespace graspdb::server
