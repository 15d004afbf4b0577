// The file of --config, of the server and of the client.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

namespace graspdb {

// Adds --config, and makes every flag that `app` and its commands have by now a variable too:
// --area-m is GRASPDB_AREA_M. A flag goes before its variable, and both go before the file; a
// key that is no flag is an error, but for those of `other_commands`, which are another program's.
void AddSettingsFile(CLI::App& app, std::vector<std::string> other_commands = {});

// Parses what a program was started with, and prints what there is to say: help, a version, or what
// is wrong. The exit status where the program is to end by that, 0 or 2.
std::optional<int> ParseArguments(CLI::App& app, int argc, char** argv);

}  // namespace graspdb
