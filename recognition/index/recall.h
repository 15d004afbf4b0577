// An approximate index with enough checks.
#pragma once

#include "absl/status/statusor.h"
#include "recognition/index/descriptor_index.h"

namespace graspdb::recognition {

// `index` with an approximate index of all its views. Its number of checks is twice the smallest
// power of two, from 1,024 on, with which it finds at least 99.5 % of the 10 nearest of 100 views
// spread evenly over it, each left out of its own neighbours: the catalogue's own views are easier
// queries than views of its objects from other sides. Each try costs an approximate search of each,
// the first an exact one too: a second for a million views. Errors as ApproximateIndex::Build.
absl::StatusOr<DescriptorIndex> WithNewApproximate(const DescriptorIndex& index);

}  // namespace graspdb::recognition
