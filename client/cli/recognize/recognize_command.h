// `graspdb recognize`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `recognize FILE|SET… [--split QUERY] [--cell NAME]`.
void AddRecognizeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
