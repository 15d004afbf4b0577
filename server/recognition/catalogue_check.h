// FindLookAlikes and ProposeThresholds on the live catalogue.
#pragma once

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/recognizer.h"
#include "recognition/threshold_proposals.h"
#include "server/live/live_catalogue.h"

namespace graspdb::server {

// Uses the current snapshot of the catalogue. Thread-safe.
class CatalogueCheck {
 public:
  // The references must outlive this.
  CatalogueCheck(const LiveCatalogue& live, recognition::ViewClouds& clouds,
                 const recognition::RecognitionParameters& parameters)
      : live_(live), clouds_(clouds), parameters_(parameters) {}

  // NOT_FOUND for an object that has no stable poses, and the errors of
  // recognition::FindLookAlikes.
  absl::StatusOr<v1::FindLookAlikesResponse> FindLookAlikes(
      const v1::FindLookAlikesRequest& request, const recognition::IsCancelled& is_cancelled);

  // The last message of the stream. `progress` as for recognition::ProposeThresholds. NOT_FOUND for
  // an object that has no stable poses, ABORTED when views were deleted meanwhile, and the errors
  // of recognition::ProposeThresholds.
  absl::StatusOr<v1::ProposeThresholdsResponse> ProposeThresholds(
      const v1::ProposeThresholdsRequest& request, const recognition::IsCancelled& is_cancelled,
      const recognition::ThresholdProgress& progress);

 private:
  const LiveCatalogue& live_;
  recognition::ViewClouds& clouds_;
  const recognition::RecognitionParameters parameters_;
};

}  // namespace graspdb::server
