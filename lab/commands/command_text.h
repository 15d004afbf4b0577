// A command as it could be typed again.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace graspdb::client {

// "graspdb eval a.ply --trials 3": the options that were given, in the order in which the command
// declares them, quoted for a shell. Wherever they came from: command line, environment or file.
std::string CommandText(const CLI::App& command);

}  // namespace graspdb::client
