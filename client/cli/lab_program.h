// Commands of the program `graspdb-lab`, which users type as commands of `graspdb`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace graspdb::client {

std::vector<std::string> LabCommands();

// Lists the commands in the help of `app`.
void AddLabCommands(CLI::App& app);

// Where the command line names one of them, runs graspdb-lab, which lies beside this program, in
// this process's place, or exits with 1 and says what is missing. Else does nothing.
void RunLabCommand(const CLI::App& app, int argc, char** argv);

}  // namespace graspdb::client
