// The `request_id` of a write that its caller may send again.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::server {

// In lower case; empty where the request has none. INVALID_ARGUMENT with the field unless it is a
// UUID of version 4.
absl::StatusOr<std::string> WriteIdFromProto(std::string_view request_id);

}  // namespace graspdb::server
