// `graspdb export`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `export SET`.
void AddExportCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
