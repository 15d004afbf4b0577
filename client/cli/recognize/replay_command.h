// `graspdb replay`: asks again what a cell's black box kept.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

void AddReplayCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
