// Creates or updates cells.
#pragma once

#include "absl/status/statusor.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Updates the cell if it exists (`is_there`), else creates it. Errors of the client.
absl::StatusOr<v1::Cell> SaveCell(Client& client, const v1::UpdateCellRequest& update,
                                  bool is_there);

}  // namespace graspdb::client
