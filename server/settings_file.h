// The file of --config.
#pragma once

#include <CLI/CLI.hpp>

namespace graspdb::server {

// Adds --config, which GRASPDB_CONFIG may give as well. A flag goes before its variable,
// and both go before the file; a key that is no flag is an error.
void AddSettingsFile(CLI::App& app);

}  // namespace graspdb::server
