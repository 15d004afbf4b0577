// Cells that may not be there yet.
#pragma once

#include "absl/status/statusor.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Updates the cell, or makes it as the request has it where it is not there. Errors of the client.
absl::StatusOr<v1::Cell> SaveCell(Client& client, const v1::UpdateCellRequest& update,
                                  bool is_there);

}  // namespace graspdb::client
