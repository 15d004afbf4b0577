// The commands of `graspdb-lab`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `bench SCAN…|--simulate [--concurrency N] [--rate R] [--requests N] [--duration S]`.
void AddBenchCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `robot`: a simulated robot picks objects before a simulated camera.
void AddRobotCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `simulate [MESH…] --out SET`, which writes a capture set.
void AddSimulateCommand(CLI::App& app, Action* action);

// Adds `eval MESH…`, which prints a line for each case.
void AddEvalCommand(CLI::App& app, Action* action);

}  // namespace graspdb::client
