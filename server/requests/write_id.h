// What a repeated write is recognised by: its `request_id`, and the digest of its content.
#pragma once

#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::server {

// In lower case; empty where the request has none. INVALID_ARGUMENT with the field unless it is a
// UUID of version 4.
absl::StatusOr<std::string> WriteIdFromProto(std::string_view request_id);

// SHA-256 of `content`: 32 bytes.
std::string Sha256(std::string_view content);

}  // namespace graspdb::server
