// `graspdb recognize`, `describe` and `replay`.
#pragma once

#include "client/cli/base/command.h"

namespace graspdb::client {

// Adds `recognize FILE|SET… [--split QUERY] [--cell NAME]`.
void AddRecognizeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `describe FILE [--descriptor NAME] [--viewpoint X,Y,Z]`, which works without a server.
void AddDescribeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `replay BUNDLE…`, which resends the requests in a cell's black box.
void AddReplayCommand(CLI::App& app, const GlobalOptions& global, Action* action);

}  // namespace graspdb::client
