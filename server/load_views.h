// Loads all views of the catalogue.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/cancellation.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "server/loaded_views.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// The views of the records, read in one pass with the records for `others`. Names of those without
// a descriptor of these parameters are added to `undescribed`; they are left out.
absl::StatusOr<LoadedViews> ReadViews(const storage::Catalogue& catalogue,
                                      const recognition::DescriptorParameters& parameters,
                                      storage::RecordVisitor others,
                                      std::vector<std::string>* undescribed);

// Recomputes the descriptors of the named views from the clouds, and stores them; except of views
// whose records or clouds cannot be used.
//
// FAILED_PRECONDITION for a view that cannot be described with `parameters`, and the errors of the
// catalogue. CANCELLED within some milliseconds after `is_cancelled`, with the views until then
// stored.
absl::Status Redescribe(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                        const recognition::DescriptorParameters& parameters,
                        const recognition::IsCancelled& is_cancelled);

// Redescribe() for views that a call brought into the catalogue. A view that cannot be described
// gets a descriptor without bins and is left out, also at the next starts: it does not prevent
// them. Some milliseconds for each view.
absl::Status DescribeViews(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                           const recognition::DescriptorParameters& parameters);

// DescribeViews() for those of one object that have no descriptor of these parameters.
absl::Status DescribeObject(storage::Catalogue& catalogue, const std::string& object,
                            const recognition::DescriptorParameters& parameters);

}  // namespace graspdb::server
