// Misspelled commands.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace graspdb {

// After `app` has failed to parse its arguments: the error that names the word in the place of a
// command, with the nearest command if it is a slip of two letters at most. Empty if the error is
// another one.
std::string UnknownCommandError(const CLI::App& app);

}  // namespace graspdb
