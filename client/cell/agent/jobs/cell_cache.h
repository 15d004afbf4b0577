// The cell's record and the labels of objects on the server, kept up to date.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "client/cell/agent/jobs/cell_frames.h"
#include "client/sdk/client.h"
#include "program/base/monotonic_time.h"
#include "program/base/stop_flag.h"

namespace graspdb::client {

// The cell as last read.
struct KeptCell {
  CellFrames frames;
  std::optional<recognition::Box> workspace;  // world frame
};

// Reads the cell periodically in the background, which also monitors the server. Keeps the last
// cell while the server is unavailable. Thread-safe.
class CellCache {
 public:
  // `cell` is a resource name. `client` must outlive this.
  CellCache(Client& client, std::string cell, absl::Duration period);
  ~CellCache();
  CellCache(const CellCache&) = delete;
  CellCache& operator=(const CellCache&) = delete;

  // The cached cell; read until `deadline` if there is none yet. Errors of the server; NOT_FOUND
  // becomes FAILED_PRECONDITION, with the command to run.
  absl::StatusOr<KeptCell> Get(MonotonicTime deadline);

  // Reads the cell now, e.g. after a calibration, within `timeout`, by default that of the client.
  absl::Status Refresh(std::optional<absl::Duration> timeout = std::nullopt);

  // Status of the last read that had all of the client's time.
  absl::Status state() const;

  // Read after an outage of the server, and every twelfth period; empty before.
  std::string server_version() const;

 private:
  void Watch();
  void ReadServerVersion();

  Client& client_;
  const std::string name_;
  const absl::Duration period_;
  mutable absl::Mutex mutex_;
  absl::StatusOr<KeptCell> cell_ ABSL_GUARDED_BY(mutex_);
  absl::Status state_ ABSL_GUARDED_BY(mutex_);
  bool is_state_known_ ABSL_GUARDED_BY(mutex_) = false;  // and logged
  std::string server_version_ ABSL_GUARDED_BY(mutex_);
  std::atomic<std::uint64_t> requests_ = 0;
  std::uint64_t kept_request_ ABSL_GUARDED_BY(mutex_) = 0;  // whose answer they are
  StopFlag stop_;
  std::thread thread_;
};

// Pairs of object (resource name) and label.
using LabelledObjects = std::set<std::pair<std::string, std::string>>;

// Lists the objects again whenever the catalogue or its revision differs. Thread-safe.
class Labels {
 public:
  // `client` must outlive this.
  explicit Labels(Client& client) : client_(client) {}

  // As of this revision of the catalogue with this id, or of a later one if there is one already.
  // Servers of earlier versions send no id: then a restored catalogue is known by its older
  // revision only. Errors of the server.
  absl::StatusOr<std::shared_ptr<const LabelledObjects>> At(const std::string& catalog_id,
                                                            std::int64_t revision);

 private:
  Client& client_;
  absl::Mutex mutex_;
  std::string catalog_id_ ABSL_GUARDED_BY(mutex_);
  std::int64_t revision_ ABSL_GUARDED_BY(mutex_) = -1;
  std::shared_ptr<const LabelledObjects> objects_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
