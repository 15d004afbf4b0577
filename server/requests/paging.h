// Pages of lists (AIP-158).
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::server {

// 0 means 100, more than 1000 means 1000; negative is INVALID_ARGUMENT.
absl::StatusOr<std::size_t> PageSize(std::int32_t requested);

// The token for the page after `last_name`, and back. INVALID_ARGUMENT for a token
// that is not from a list of names with this prefix.
std::string PageTokenAfter(std::string_view last_name);
absl::StatusOr<std::string> NameFromPageToken(std::string_view token, std::string_view prefix);

}  // namespace graspdb::server
