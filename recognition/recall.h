// How much an approximate index finds of what the exact search finds.
#pragma once

#include "absl/status/statusor.h"
#include "recognition/descriptor_index.h"

namespace graspdb::recognition {

// The share of the 10 nearest views that `index` finds with its approximate index, for 100 views
// spread evenly over it, each left out of its own neighbours. 1 without one. An exact and an
// approximate search each: a second for a million views.
double RecallAt10(const DescriptorIndex& index);

// `index` with an approximate one of all its views that looks at so many views a search that the
// recall is above 99.5 % for the catalogue's own views, and at twice as many: views of known
// things from new sides are found less often. Errors as ApproximateIndex::Build.
absl::StatusOr<DescriptorIndex> WithNewApproximate(const DescriptorIndex& index);

}  // namespace graspdb::recognition
