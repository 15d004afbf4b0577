// `graspdb eval`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

#include "absl/status/status.h"

namespace graspdb::client {

// Adds `eval MESH…` to `app`. When the command line chooses it, parsing sets `*action` (which
// outlives the parsing) to a function that prints a line for each case.
void AddEvalCommand(CLI::App& app, std::function<absl::Status()>* action);

}  // namespace graspdb::client
