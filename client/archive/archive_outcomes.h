// Counts of picks of an archive.
#pragma once

#include <functional>

#include "absl/status/statusor.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Raises the server's counts of picks of this stable pose to the file's, where they are lower, and
// returns whether any was. Counts of grasps that the server does not have are left out. Calls
// `go_on` before each report; an error of its own ends it. Errors of the server.
absl::StatusOr<bool> RaiseOutcomesTo(const v1::StablePose& file, Client& client,
                                     const std::function<absl::Status()>& go_on);

}  // namespace graspdb::client
