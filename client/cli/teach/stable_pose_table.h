// The stable poses of a mesh as a table, to choose which ones to teach.
#pragma once

#include <string>

#include "client/teaching/mesh/cad_part.h"

namespace graspdb::client {

// A line for every stable pose: its number and name, probability, tip angle, symmetry, size and
// grasps; and the probability of the omitted ones. Ends with a line end.
std::string StablePoseTable(const CadPart& part);

}  // namespace graspdb::client
