// The file of --identities.
#pragma once

#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "server/access/identities.h"
#include "server/access/watched_files.h"

namespace graspdb::server {

// Reads the file again within two seconds after it changes. A file that cannot be read or has an
// error is logged and read each second, and the identities before it stay. Thread-safe.
class IdentitiesFile {
 public:
  // FAILED_PRECONDITION for a file that cannot be read or has an error, with the line.
  static absl::StatusOr<std::unique_ptr<IdentitiesFile>> Open(const std::string& path);

  std::shared_ptr<const Identities> Get() const;

 private:
  explicit IdentitiesFile(const std::string& path);
  absl::Status Load();

  const std::string path_;
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Identities> identities_ ABSL_GUARDED_BY(mutex_);
  WatchedFiles file_;  // last: its thread uses the others
};

}  // namespace graspdb::server
