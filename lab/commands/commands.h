// The commands of `graspdb-lab`.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "client/cli/base/command.h"

namespace graspdb::lab {

// Adds `bench SCAN…|--simulate [--concurrency N] [--rate R] [--requests N] [--duration S]`.
void AddBenchCommand(CLI::App& app, const client::GlobalOptions& global, client::Action* action);

// Adds `robot`: a simulated robot picks objects before a simulated camera.
void AddRobotCommand(CLI::App& app, const client::GlobalOptions& global, client::Action* action);

// Adds `simulate [MESH…] --out SET`, which writes a capture set.
void AddSimulateCommand(CLI::App& app, client::Action* action);

// Adds `eval MESH…`, which prints a line for each case.
void AddEvalCommand(CLI::App& app, client::Action* action);

// "graspdb eval a.ply --trials 3": the options that are set on the command line, in the environment
// or in a file, in the order in which the command declares them, quoted for a shell.
std::string CommandText(const CLI::App& command);

}  // namespace graspdb::lab
