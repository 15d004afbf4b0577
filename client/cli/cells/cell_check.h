// `graspdb cells check`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds it under `cells`.
void AddCheckCommand(CLI::App& cells, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
