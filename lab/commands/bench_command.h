// `graspdb bench`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `bench SCAN…|--simulate [--concurrency N] [--rate R] [--requests N] [--duration S]`.
void AddBenchCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
