// `graspdb grasps import`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds the command under `grasps`.
void AddGraspsImportCommand(CLI::App& grasps, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
