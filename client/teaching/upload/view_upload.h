// Views sent to a catalogue: what is there already is not sent again. All functions are
// thread-safe; they call what they are given from the thread that calls them.
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

// Makes the objects and stable poses that are not there; the others keep what they have, their
// grasps too. Errors of the server.
absl::Status CreateParents(Client& client, const std::vector<v1::CapturedObject>& objects);

// Views to teach.
struct ViewsToTeach {
  std::size_t count = 0;
  // Makes view number 0 … count - 1, its parent and view among them; without `view_id` it gets one
  // from its cloud (ContentId). An error ends the upload.
  std::function<absl::Status(std::size_t, v1::UploadViewsRequest*)> make;
  // Views that are there are deleted and taught again.
  bool replace = false;
};

// Either may be empty.
struct UploadWatch {
  std::function<void(std::size_t done)> report;
  std::function<bool()> cancelled;
};

struct UploadCounts {
  int created = 0;
  int existing = 0;  // were there already
};

// Teaches the views in turn, some in a call: each is safe once it is reported, so that an upload
// that was broken off is done again from the start. CANCELLED when the watch says so, with how many
// are safe; errors of `make` and of the server.
absl::StatusOr<UploadCounts> TeachViews(Client& client, const ViewsToTeach& views,
                                        const UploadWatch& watch);

}  // namespace graspdb::client
