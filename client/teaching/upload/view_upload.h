// Uploads views to a catalogue; existing views are not sent again. All functions are thread-safe;
// they call their callbacks from the calling thread.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"
#include "graspdb/v1/capture_set.pb.h"

namespace graspdb::client {

// The resource name of a stable pose.
std::string StablePoseName(const std::string& object_id, const std::string& stable_pose_id);

// Creates the objects and stable poses that do not exist; the others are unchanged, including their
// grasps. Errors of the server.
absl::Status CreateParents(Client& client, const std::vector<v1::CapturedObject>& objects);

// Views to teach.
struct ViewsToTeach {
  std::size_t count = 0;
  // Fills the request for view 0 … count - 1, with parent and view; without `view_id` it gets one
  // from its content (ContentId). An error ends the upload.
  std::function<absl::Status(std::size_t, v1::UploadViewsRequest*)> make;
  // Delete existing views and teach them again.
  bool replace = false;
  // How errors name a view; null: by its number.
  std::function<std::string(std::size_t)> name_of = nullptr;
};

// Fills the request for view `i`, its id included. Errors of `views.make`.
absl::Status MakeRequest(const ViewsToTeach& views, std::size_t i, v1::UploadViewsRequest* request);

// The resource name of its view.
std::string ViewNameOf(const v1::UploadViewsRequest& request);

// Both callbacks are optional.
struct UploadWatch {
  std::function<void(std::size_t done)> report;
  std::function<bool()> cancelled;
};

struct UploadCounts {
  int created = 0;
  int existing = 0;  // already in the catalogue
};

// Teaches the views in order, several per call: each is stored once it is reported, so an
// interrupted upload can be repeated from the start. CANCELLED when the watch requests it, with the
// number of stored views; errors of `make` and of the server.
absl::StatusOr<UploadCounts> TeachViews(Client& client, const ViewsToTeach& views,
                                        const UploadWatch& watch);

// INVALID_ARGUMENT for a step that is not between 1 and 120 degrees.
absl::Status CheckStep(double step_deg);

// The number of steps 0, step, 2 step, … below 360 degrees; 0 for a step that CheckStep rejects.
int StepsOf(double step_deg);

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
