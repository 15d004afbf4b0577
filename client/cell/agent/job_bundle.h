// Jobs as bundles of a black box.
#pragma once

#include <optional>

#include "client/cell/agent/cell_runner.h"
#include "graspdb/v1/bundle.pb.h"

namespace graspdb::client {

// What is to be kept of a job, ready to be asked again; nothing where the server was not asked, as
// when the camera gave no frame.
std::optional<v1::Bundle> BundleOf(const JobReport& report);

}  // namespace graspdb::client
