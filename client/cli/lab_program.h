// Commands of `graspdb` that the program `graspdb-lab` implements.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace graspdb::client {

std::vector<std::string> LabCommands();

// Lists the commands in the help of `app`.
void AddLabCommands(CLI::App& app);

// If the command line names one of them, replaces this process with graspdb-lab, which is beside
// this program, or prints an error and exits with 1. Else does nothing.
void RunLabCommand(const CLI::App& app, int argc, char** argv);

}  // namespace graspdb::client
