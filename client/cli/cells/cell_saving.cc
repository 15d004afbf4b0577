#include "client/cli/cells/cell_saving.h"

#include <string>

namespace graspdb::client {

absl::StatusOr<v1::Cell> SaveCell(Client& client, const v1::UpdateCellRequest& update,
                                  bool is_there) {
  if (is_there) return client.UpdateCell(update);
  v1::CreateCellRequest create;
  create.set_cell_id(update.cell().name().substr(std::string("cells/").size()));
  *create.mutable_cell() = update.cell();
  return client.CreateCell(create);
}

}  // namespace graspdb::client
