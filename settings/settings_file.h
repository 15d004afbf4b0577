// The file of --config, of the server and of the client.
#pragma once

#include <CLI/CLI.hpp>

namespace graspdb {

// Adds --config, and makes every flag that `app` and its commands have by now a variable too:
// --area-m is GRASPDB_AREA_M. A flag goes before its variable, and both go before the file; a
// key that is no flag is an error.
void AddSettingsFile(CLI::App& app);

}  // namespace graspdb
