// Workpieces made by code, for simulations that need no files.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "rendering/workpiece.h"

namespace graspdb::rendering {

// Thirteen workpieces of 4 to 16 cm at rest, in a fixed order. Every mesh is a union of closed
// shells. A handle, a wedge, brackets and blocks look different from every side; a flange (4-fold),
// a hexagonal nut (6-fold), a z-bar (2-fold) and a shaft (any turn) are symmetric; bracket-left and
// bracket-right are mirror images of each other.
std::vector<Workpiece> SampleParts();

// Their object ids, in that order.
std::vector<std::string> SamplePartIds();

// Those with these ids, in SampleParts' order; all if `ids` is empty. INVALID_ARGUMENT for an
// unknown id.
absl::StatusOr<std::vector<Workpiece>> SampleParts(const std::vector<std::string>& ids);

}  // namespace graspdb::rendering
