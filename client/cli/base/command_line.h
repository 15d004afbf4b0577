// What the programs of the command line do alike.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "client/cli/base/command.h"

namespace graspdb::client {

// The flags that stand before or behind any command.
void AddGlobalFlags(CLI::App& app, GlobalOptions* global);

// Reads the command line into `app`, whose commands set `*action`, and runs that. Returns the exit
// status: 0 done, 1 understood but failed, 2 wrong usage, 3 no server there. A settings file may
// have sections of `other_commands`, which are another program's.
int RunCommandLine(CLI::App& app, const Action& action, std::vector<std::string> other_commands,
                   int argc, char** argv);

}  // namespace graspdb::client
