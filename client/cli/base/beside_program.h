// Other programs of graspdb, which are installed beside this one.
#pragma once

#include <string>
#include <vector>

#include "absl/status/status.h"

namespace graspdb::client {

// Replaces this process with `program`, which gets `arguments`. Returns only if that fails.
absl::Status BecomeProgram(const std::string& program, std::vector<std::string> arguments);

}  // namespace graspdb::client
