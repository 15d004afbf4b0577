// What the catalogue may confuse, as an answer.
#pragma once

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/recognizer.h"
#include "server/live_catalogue.h"

namespace graspdb::server {

// Compares the stable poses of the catalogue as it is now. Thread-safe.
class LookAlikeFinder {
 public:
  // The references must outlive this.
  LookAlikeFinder(const LiveCatalogue& live, recognition::ViewClouds& clouds)
      : live_(live), clouds_(clouds) {}

  // NOT_FOUND for an object that has no stable poses, and the errors of
  // recognition::FindLookAlikes.
  absl::StatusOr<v1::FindLookAlikesResponse> Answer(const v1::FindLookAlikesRequest& request,
                                                    const recognition::IsCancelled& is_cancelled);

 private:
  const LiveCatalogue& live_;
  recognition::ViewClouds& clouds_;
};

}  // namespace graspdb::server
