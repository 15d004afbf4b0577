// What the server says of the cell, kept up to date.
#pragma once

#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/cell/agent/cell_frames.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// The cell as it was read last.
struct KeptCell {
  CellFrames frames;
  std::optional<recognition::Box> workspace;  // world frame
};

// Reads the cell again and again in the background, and by that knows whether the server is there.
// What was read once is kept while the server is away. Thread-safe.
class CellCache {
 public:
  // `cell` is a resource name. `client` must outlive this.
  CellCache(Client& client, std::string cell, absl::Duration period);
  ~CellCache();
  CellCache(const CellCache&) = delete;
  CellCache& operator=(const CellCache&) = delete;

  // The cell; read now where it has never been. Errors of the server; NOT_FOUND becomes
  // FAILED_PRECONDITION, with what to do.
  absl::StatusOr<KeptCell> Get();

  // Reads it now, as after a calibration.
  absl::Status Refresh();

  // What the last read came to.
  absl::Status state() const;

 private:
  void Watch();

  Client& client_;
  const std::string name_;
  const absl::Duration period_;
  mutable absl::Mutex mutex_;
  absl::StatusOr<KeptCell> cell_ ABSL_GUARDED_BY(mutex_);
  absl::Status state_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace graspdb::client
