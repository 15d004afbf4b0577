// `graspdb cells level` and `graspdb cells check`.
#pragma once

#include "client/cli/command.h"

namespace graspdb::client {

// Adds them under `cells`.
void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action);
void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
