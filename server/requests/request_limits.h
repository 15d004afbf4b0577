// Limits on the lengths and counts of a request's fields, all in one place. The proto comments have
// the same limits.
#pragma once

#include <google/protobuf/message.h>

#include <cstddef>
#include <string_view>

#include "absl/status/status.h"

namespace graspdb::server {

// Grasps of a stable pose, as in the contract. A response proposes each of them for every turn of
// the symmetry and of its free turn, so twice as many make responses twice as long.
inline constexpr int kMaxGrasps = 64;

// Bytes of a string without a limit of its own. The longest resource name has 217; twice as many
// would only make errors longer.
inline constexpr std::size_t kMaxStringBytes = 256;

// Bytes of a display name, as UTF-8. A page of a list has up to 1000; twice as many would still
// fit.
inline constexpr std::size_t kMaxNameBytes = 256;

// INVALID_ARGUMENT with the field's path for the first string that is too long or repeated field
// with too many elements in `request`, however deep. Fields of `bytes` are left out: they are
// bounded by --max-message-mib and --max-points. Linear in what the limits allow.
absl::Status CheckLimits(const google::protobuf::Message& request);

// The same for a single string.
absl::Status CheckLength(std::string_view text, std::string_view path);

}  // namespace graspdb::server
