// The `teach` command.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `teach OBJECT --mesh FILE --unit UNIT` to `app`; see AddCommand. `global` outlives the
// action.
void AddTeachCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
