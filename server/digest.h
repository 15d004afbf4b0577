// Digests of content.
#pragma once

#include <string>
#include <string_view>

namespace graspdb::server {

// SHA-256 of `content`: 32 bytes.
std::string Sha256(std::string_view content);

}  // namespace graspdb::server
