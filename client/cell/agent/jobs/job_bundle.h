// Jobs as bundles of a black box.
#pragma once

#include <optional>
#include <string>

#include "client/cell/agent/jobs/cell_runner.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

// The bundle of a job, ready for replay: with what the server answered, not what the robot got.
// nullopt if no request was made, e.g. without a camera frame. The version may be empty.
std::optional<v1::Bundle> BundleOf(const JobReport& report, const std::string& server_version);

}  // namespace graspdb::client
