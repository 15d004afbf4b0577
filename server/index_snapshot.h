// The index beside the database, so that a start need not read all records. Rebuilt from the
// records if it may be wrong; docs/adr/0014-an-index-beside-the-database.md.
#pragma once

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "recognition/recognizer.h"
#include "server/loaded_views.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Changes that the file may be behind before reading all records is faster.
inline constexpr std::int64_t kMaxChangesBehind = 20'000;

// Replaces the file with the index of `snapshot`, one of `catalogue`; `parameters` are those of its
// descriptors. Needs some megabytes of memory, and takes no lock. One at a time. UNAVAILABLE when
// the disk fails; the old file stays then.
absl::Status WriteIndexSnapshot(const storage::Catalogue& catalogue,
                                const recognition::CatalogueSnapshot& snapshot,
                                const recognition::DescriptorParameters& parameters);

// The views and the index of the current catalogue, from the file and the records that changed
// since it was written. The catalogue must not change meanwhile.
//
// NOT_FOUND without a file, DATA_LOSS for a damaged one, FAILED_PRECONDITION for one that was built
// from another database, another history of this one or with other parameters, or is too far
// behind; and the errors of the catalogue.
absl::StatusOr<LoadedViews> ReadIndexSnapshot(const storage::Catalogue& catalogue,
                                              const recognition::DescriptorParameters& parameters);

}  // namespace graspdb::server
