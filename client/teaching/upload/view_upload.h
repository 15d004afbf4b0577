// Uploads views to a catalogue; existing views are not sent again. All functions are thread-safe;
// they call their callbacks from the calling thread.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
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

}  // namespace graspdb::client
