// `graspdb robot`: a simulated robot picks objects before a simulated camera.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

void AddRobotCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
