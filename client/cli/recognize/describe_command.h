// `graspdb describe`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `describe FILE [--descriptor NAME] [--viewpoint X,Y,Z]`, which works
// without a server.
void AddDescribeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
