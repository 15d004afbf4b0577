// `graspdb import`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `import SET [--split TEACH]`.
void AddImportCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
