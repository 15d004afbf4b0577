// Teaching: from an uploaded capture to a view of the catalogue.
#pragma once

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "recognition/recognizer.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// What an upload may hold.
struct TeachLimits {
  std::size_t max_points = 2'000'000;
};

// Finds the object in the capture with the same code that recognises it, and makes
// the record of the view: the object's points packed, its descriptor made from the
// packed points, so that it can be made again from what is stored. Errors name the
// field at `path`; FAILED_PRECONDITION when the capture shows nothing or, without an
// object pose, several objects.
absl::StatusOr<storage::NewView> MakeView(const v1::UploadViewsRequest& request,
                                          const recognition::RecognitionParameters& parameters,
                                          const TeachLimits& limits,
                                          const recognition::IsCancelled& is_cancelled);

// Digest of what was uploaded; equal digests mean the same view.
std::string UploadDigest(const v1::UploadViewsRequest& request);

}  // namespace graspdb::server
