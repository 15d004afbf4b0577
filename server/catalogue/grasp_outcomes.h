// Reports of grasp outcomes, between the contract and the storage.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Counts the reported outcome and returns true; false for a repeated request, which gets the first
// answer. INVALID_ARGUMENT with the field; NOT_FOUND without the stable pose or the grasp;
// ALREADY_EXISTS with REQUEST_ID_REUSED.
absl::StatusOr<bool> ReportGraspOutcome(const v1::ReportGraspOutcomeRequest& request,
                                        storage::Catalogue& catalogue,
                                        v1::ReportGraspOutcomeResponse* response);

// Fills in the outcomes, which are stored apart from the stable pose.
absl::Status AddGraspOutcomes(const storage::Catalogue& catalogue, v1::StablePose* stable_pose);

// The sums over all grasps.
absl::Status SumGraspOutcomes(const storage::Catalogue& catalogue, v1::CatalogStatus* status);

}  // namespace graspdb::server
