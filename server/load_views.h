// Loads all views of the catalogue, from the index file if possible.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "server/loaded_views.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// The current views, from the index beside the database if that is valid, else from the records;
// logs which of them, and why. Descriptors with other parameters are recomputed from the clouds,
// and stored. No other thread may change the catalogue meanwhile. Views whose records or clouds
// cannot be used are left out.
//
// FAILED_PRECONDITION for a view that cannot be described with `parameters`, and the errors of the
// catalogue.
absl::StatusOr<LoadedViews> LoadViews(storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters);

// The views of the records, read in one pass with the records for `others`. Names of those without
// a descriptor of these parameters are added to `undescribed`; they are left out.
absl::StatusOr<LoadedViews> ReadViews(const storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters,
                                      storage::RecordVisitor others,
                                      std::vector<std::string>* undescribed);

}  // namespace graspdb::server
