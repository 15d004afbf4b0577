// Pictures of recognition results.
#pragma once

#include <filesystem>

#include "client/cli/recognize/scan_source.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Writes `folder`/NAME.png for a scan and its response (the paper's figures 10 and
// 16): the scan white, the matched view green as found, shifted and refined, and
// the axes of the best grasp. Fetches the view's cloud from the server.
absl::Status WritePicture(Client& client, const std::filesystem::path& folder, const ScanTask& task,
                          const v1::RecognizeRequest& request,
                          const v1::RecognizeResponse& response);

}  // namespace graspdb::client
