// The file of --identities.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "program/tls/watched_files.h"
#include "server/access/file_state.h"
#include "server/access/identities.h"

namespace graspdb::server {

// Reads the file again within two seconds after it changes. A file that cannot be read, has an
// error or no identity at all is logged and read each second, and the identities before it stay; it
// has a fault until then. Thread-safe.
class IdentitiesFile {
 public:
  // FAILED_PRECONDITION for a file that cannot be read, has an error, with the line, or no
  // identity.
  static absl::StatusOr<std::unique_ptr<IdentitiesFile>> Open(const std::string& path);

  std::shared_ptr<const Identities> Get() const;

  // Why the file cannot be used as it is now; absent while it can.
  std::optional<FileFault> fault() const { return state_.fault(); }

 private:
  explicit IdentitiesFile(const std::string& path);
  absl::Status Load();

  const std::string path_;
  FileState state_{"--identities"};
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Identities> identities_ ABSL_GUARDED_BY(mutex_);
  WatchedFiles file_;  // last: its thread uses the others
};

}  // namespace graspdb::server
