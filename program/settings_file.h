// The command line of a program, and the file of --config.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace graspdb {

// After `app` has failed to parse its arguments: the error that names the word in the place of a
// command, with the nearest command if it is a slip of two letters at most. Empty if the error is
// another one.
std::string UnknownCommandError(const CLI::App& app);

// Adds --config, and an environment variable for every flag that `app` and its commands have so
// far: --area-m is GRASPDB_AREA_M, unless the option has a variable already. A flag overrides its
// variable, and both override the file; an unknown key is an error, except those of
// `other_commands`, which belong to another program.
void AddSettingsFile(CLI::App& app, std::vector<std::string> other_commands = {});

// Parses the command line, and prints the help, the version or an error. Returns the exit status, 0
// or 2, if the program is to end.
std::optional<int> ParseArguments(CLI::App& app, int argc, char** argv);

}  // namespace graspdb
