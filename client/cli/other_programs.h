// Commands of `graspdb` that other programs implement: `graspdb-lab` and `graspdb-console`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace graspdb::client {

std::vector<std::string> OtherCommands();

// Lists the commands in the help of `app`.
void AddOtherCommands(CLI::App& app);

// If the command line names one of them, replaces this process with its program, which is beside
// this one, or prints an error and exits with 1. Else does nothing.
void RunOtherCommand(const CLI::App& app, int argc, char** argv);

}  // namespace graspdb::client
