// `graspdb grasps`: taught grasps and their reported outcomes.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

void AddGraspsCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
