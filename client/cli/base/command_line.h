// Shared by the command-line programs.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "client/cli/base/command.h"

namespace graspdb::client {

// The flags that may precede or follow any command.
void AddGlobalFlags(CLI::App& app, GlobalOptions* global);

// Reads the command line into `app`, whose commands set `action`, and runs that. Returns the exit
// status: 0 done, 1 failed, 2 wrong usage, 3 no server reachable. A settings file may have sections
// of `other_commands`, which belong to another program.
int RunCommandLine(CLI::App& app, const GlobalOptions& global, const Action& action,
                   std::vector<std::string> other_commands, int argc, char** argv);

}  // namespace graspdb::client
