// The views that a catalogue has.
#pragma once

#include <map>
#include <set>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Lists the views of each stable pose once. Thread-safe.
class KnownViews {
 public:
  explicit KnownViews(Client& client) : client_(client) {}

  // Errors of the server.
  absl::StatusOr<bool> Has(const std::string& stable_pose, const std::string& view_id) {
    absl::MutexLock lock(&mutex_);
    auto found = names_.find(stable_pose);
    if (found == names_.end()) {
      absl::StatusOr<std::vector<v1::View>> views = client_.ListViews(stable_pose);
      // A stable pose that does not exist has none.
      if (absl::IsNotFound(views.status())) views.emplace();
      if (!views.ok()) return views.status();
      std::set<std::string> names;
      for (const v1::View& view : *views) names.insert(view.name());
      found = names_.emplace(stable_pose, std::move(names)).first;
    }
    return found->second.contains(stable_pose + "/views/" + view_id);
  }

 private:
  Client& client_;
  absl::Mutex mutex_;
  std::map<std::string, std::set<std::string>> names_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
