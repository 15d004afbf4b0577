// `graspdb replay`: resends the requests in a cell's black box.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

void AddReplayCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
