// The `simulate` command.
#pragma once

#include <functional>

#include "absl/status/status.h"

namespace CLI {
class App;
}

namespace graspdb::client {

// Adds `simulate [MESH…] --out SET` to `app`. When the command line chooses it, parsing sets
// `*action` (which outlives the parsing) to a function that writes the capture set, draws progress
// on stderr and prints one line on stdout, or returns the error. Wrong usage is a CLI::ParseError
// while parsing.
void AddSimulateCommand(CLI::App& app, std::function<absl::Status()>* action);

}  // namespace graspdb::client
