// `graspdb backup` without a server: graspdb-server reads the folder.
#pragma once

#include <string>
#include <vector>

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `backup restore`.
void AddRestoreCommand(CLI::App& backup, const GlobalOptions& global, Action* action);

// Lets an option for the number of a backup take its name too, as `backup list` prints it.
void AcceptBackupName(CLI::Option* number);

// Replaces this process with `graspdb-server backup COMMAND --from FOLDER ...`. Returns only if
// that fails.
absl::Status ReadFolder(const GlobalOptions& global, const std::string& command,
                        const std::string& from, const std::vector<std::string>& more);

}  // namespace graspdb::client
