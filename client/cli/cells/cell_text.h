// Cells as human-readable text.
#pragma once

#include <string>

#include "graspdb/v1/cell.pb.h"

namespace graspdb::client {

// Some lines: the calibration and settings of the cell, with a command for a missing calibration.
std::string CellText(const v1::Cell& cell);

}  // namespace graspdb::client
