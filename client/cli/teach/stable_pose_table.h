// The stable poses of a mesh in words, for who decides what is taught.
#pragma once

#include <string>

#include "client/teaching/mesh/cad_part.h"

namespace graspdb::client {

// A line for every stable pose: its number and name, how likely it is, when it tips over, what it
// looks like after turns, its size and grasps; and what was left out. Ends with a line end.
std::string StablePoseTable(const CadPart& part);

}  // namespace graspdb::client
