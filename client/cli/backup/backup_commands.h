// `graspdb backup`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `backup create|list|verify|diff|delete|restore`.
void AddBackupCommands(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
