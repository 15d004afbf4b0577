// Teaching: from an uploaded capture to a view of the catalogue.
#pragma once

#include "absl/status/statusor.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "recognition/recognizer.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Limits of an upload.
struct TeachLimits {
  std::size_t max_points = 2'000'000;
};

// Segments the object in the capture with the code of the recognition, and makes the
// record of the view: the object's points packed, its descriptor computed from the
// packed points, so that it can be recomputed from the stored record. Without its name and
// digest, which the caller knows. Errors name the
// field at `path`; FAILED_PRECONDITION when the capture shows no object or, without an
// object pose, several objects.
absl::StatusOr<storage::NewView> MakeView(const v1::UploadViewsRequest& request,
                                          const recognition::RecognitionParameters& parameters,
                                          const TeachLimits& limits,
                                          const recognition::IsCancelled& is_cancelled);

// Digest of the upload; equal digests mean the same view.
std::string UploadDigest(const v1::UploadViewsRequest& request);

}  // namespace graspdb::server
