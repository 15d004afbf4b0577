// `graspdb cells` and `graspdb sensors`.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "client/cell/calibration/target/still_scan.h"
#include "client/cli/base/command.h"
#include "client/sdk/client.h"
#include "graspdb/v1/cell.pb.h"

namespace graspdb::client {

// Adds `cells list|show|set|level|check|delete`.
void AddCellsCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Add `level` and `check` under `cells`.
void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action);
void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action);

// Adds `sensors list|grab|fakenect`.
void AddSensorsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Some lines: the calibration and settings of the cell, with a command for a missing calibration.
std::string CellText(const v1::Cell& cell);

// INVALID_ARGUMENT with the flag for poses and boxes of `cell` that no cell has in metres, so that
// they are mostly millimetres. What `cell` has not is not checked.
absl::Status CheckCellUnits(const v1::Cell& cell);

// Updates the cell if it exists (`is_there`), else creates it. Errors of the client.
absl::StatusOr<v1::Cell> SaveCell(Client& client, const v1::UpdateCellRequest& update,
                                  bool is_there);

}  // namespace graspdb::client
