// `graspdb cells`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `cells list|show|set|level|check|delete`.
void AddCellsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
