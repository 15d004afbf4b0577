// A command line that repeats a run.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace graspdb::lab {

// "graspdb eval a.ply --trials 3": the options that are set on the command line, in the environment
// or in a file, in the order in which the command declares them, quoted for a shell.
std::string CommandText(const CLI::App& command);

}  // namespace graspdb::lab
