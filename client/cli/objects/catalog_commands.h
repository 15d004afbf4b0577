// `graspdb objects` and `graspdb status`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `objects list|show|check|thresholds|delete`.
void AddObjectsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `status`.
void AddStatusCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
