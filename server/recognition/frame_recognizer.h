// Recognition of one request.
#pragma once

#include "absl/status/statusor.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "recognition/recognizer.h"
#include "server/live/live_catalogue.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Recognises frames with the current snapshot of the catalogue. Thread-safe.
class FrameRecognizer {
 public:
  // The references must outlive this.
  FrameRecognizer(const storage::Catalogue& catalogue, const LiveCatalogue& live,
                  recognition::ViewClouds& clouds,
                  const recognition::RecognitionParameters& parameters, std::size_t max_points);

  // With timings, whether the request omits them or not. INVALID_ARGUMENT with the wrong field,
  // NOT_FOUND for an unknown cell, and the errors of recognition::Recognize.
  absl::StatusOr<v1::RecognizeResponse> Answer(const v1::RecognizeRequest& request,
                                               const recognition::IsCancelled& is_cancelled);

 private:
  const storage::Catalogue& catalogue_;
  const LiveCatalogue& live_;
  recognition::ViewClouds& clouds_;
  const recognition::RecognitionParameters parameters_;
  const std::size_t max_points_;
};

}  // namespace graspdb::server
