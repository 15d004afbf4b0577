// All views of the catalogue, from where they are had the fastest.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "server/loaded_views.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// The views as they are now, from the index beside the database where that is in order, else from
// the records; which of them, and why, the log says. Views whose descriptors were made with other
// parameters are described again from their clouds, and stored. Nobody else may change the
// catalogue meanwhile. Views whose records or clouds cannot be used are left out.
//
// FAILED_PRECONDITION for a view that cannot be described with `parameters`, and the errors of the
// catalogue.
absl::StatusOr<LoadedViews> LoadViews(storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters);

// The views as the records have them, in the same reading as what `others` visits. Names of those
// without a descriptor of these parameters go to `undescribed`; they are left out.
absl::StatusOr<LoadedViews> ReadViews(const storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters,
                                      storage::RecordVisitor others,
                                      std::vector<std::string>* undescribed);

}  // namespace graspdb::server
