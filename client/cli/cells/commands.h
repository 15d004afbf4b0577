// `graspdb cells` and `graspdb sensors`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `cells list|show|set|level|check|delete`.
void AddCellsCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Add `level` and `check` under `cells`.
void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action);
void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action);

// Adds `sensors list|grab|fakenect`.
void AddSensorsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
