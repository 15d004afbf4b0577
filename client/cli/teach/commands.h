// `graspdb teach` and `graspdb grasps`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `teach OBJECT --mesh FILE --unit UNIT`.
void AddTeachCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `grasps`: taught grasps and their reported outcomes.
void AddGraspsCommand(CLI::App& app, const GlobalOptions& global, Action* action);
// Adds `import` under `grasps`.
void AddGraspsImportCommand(CLI::App& grasps, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
