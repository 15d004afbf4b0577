// Lengths of cells in another unit.
#pragma once

#include "absl/status/status.h"
#include "graspdb/v1/cell.pb.h"

namespace graspdb::client {

// INVALID_ARGUMENT with the flag for poses and boxes of `cell` that no cell has in metres, so that
// they are mostly millimetres. What `cell` has not is not checked.
absl::Status CheckCellUnits(const v1::Cell& cell);

}  // namespace graspdb::client
