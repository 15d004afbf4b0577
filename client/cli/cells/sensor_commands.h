// `graspdb sensors`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `sensors list|grab|fakenect`.
void AddSensorsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
