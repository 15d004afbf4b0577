// Cells for people to read.
#pragma once

#include <string>

#include "graspdb/v1/cell.pb.h"

namespace graspdb::client {

// Some lines: what is known of the cell, and how to find out what is not.
std::string CellText(const v1::Cell& cell);

}  // namespace graspdb::client
