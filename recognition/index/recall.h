// Recall of an approximate index.
#pragma once

#include "absl/status/statusor.h"
#include "recognition/index/descriptor_index.h"

namespace graspdb::recognition {

// The share of the 10 nearest views that `index` finds with its approximate index, for 100 views
// spread evenly over it, each left out of its own neighbours. 1 without one. Cost: an exact and an
// approximate search each, a second for a million views.
double RecallAt10(const DescriptorIndex& index);

// `index` with an approximate index of all its views. Its number of checks is twice the smallest
// power of two, from 1,024 on, with RecallAt10 of at least 99.5 %: the catalogue's own views are
// easier queries than views of its objects from other sides. Errors as ApproximateIndex::Build.
absl::StatusOr<DescriptorIndex> WithNewApproximate(const DescriptorIndex& index);

}  // namespace graspdb::recognition
