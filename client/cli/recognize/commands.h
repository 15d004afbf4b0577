// `graspdb recognize`, `describe` and `replay`.
#pragma once

#include <string>

#include "client/cli/base/command.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

// Adds `recognize FILE|SET… [--split QUERY] [--cell NAME]`.
void AddRecognizeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `describe FILE [--descriptor NAME] [--viewpoint X,Y,Z]`, which works without a server.
void AddDescribeCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Adds `replay BUNDLE…`, which resends the requests in a cell's black box.
void AddReplayCommand(CLI::App& app, const GlobalOptions& global, Action* action);

// Where the points of the scan are, if that may be why nothing was found in it; else empty.
std::string ScanHint(const v1::RecognizeRequest& request, const v1::RecognizeResponse& response);

}  // namespace graspdb::client
