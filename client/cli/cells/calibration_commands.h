// `graspdb cells level`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds it under `cells`.
void AddLevelCommand(CLI::App& cells, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
