// Workpieces made by code, for simulations that need no files.
#pragma once

#include <vector>

#include "client/simulation/workpiece.h"

namespace graspdb::client {

// Thirteen workpieces of 4 to 16 cm at rest, always the same, in a fixed order.
// Every mesh is a union of closed shells. A handle, a wedge, brackets and blocks
// look different from every side; a flange (4-fold), a hexagonal nut (6-fold), a
// z-bar (2-fold) and a shaft (any turn) are symmetric; bracket-left and
// bracket-right are mirror images of each other.
std::vector<Workpiece> SampleParts();

}  // namespace graspdb::client
