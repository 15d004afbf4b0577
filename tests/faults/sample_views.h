// Views whose stored form is known.
#pragma once

#include <string>
#include <vector>

#include "client/sdk/client.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::faults {

// Computed captures of parts, each of its own stable pose. The content of a view is the number of
// its part.
class SampleViews {
 public:
  SampleViews();

  int count() const { return static_cast<int>(contents_.size()); }
  const std::string& StablePoseOf(int content) const;
  v1::UploadViewsRequest Request(int content, const std::string& view_id) const;
  // The stored cloud as a scan; after LearnStored().
  const v1::RecognizeRequest& Scan(int content) const;

  // Creates objects and stable poses.
  absl::Status Prepare(client::Client& client) const;
  // Learns from a server, which has the stable poses only, what GetView returns for each content.
  absl::Status LearnStored(client::Client& client);
  // Whether GetView's response is that of the content, byte for byte.
  bool IsStored(const v1::View& view, int content) const;

 private:
  struct Content {
    std::string stable_pose;
    v1::View view;
    std::string stored;
    v1::RecognizeRequest scan;
  };
  std::vector<Content> contents_;
};

// Teaches one view, which may exist.
absl::Status TeachOne(client::Client& client, const v1::UploadViewsRequest& view);

}  // namespace graspdb::faults
