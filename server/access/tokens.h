// Bearer tokens.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace graspdb::server {

inline constexpr std::size_t kTokenHashBytes = 32;

// A new token: "graspdb_" and 256 random bits of OpenSSL, in base64url. Empty if there is no
// randomness.
std::string NewToken();

// SHA-256 of a token. That is enough for 256 random bits: a slow hash, as for passwords, protects
// what can be guessed.
std::string HashToken(std::string_view token);

}  // namespace graspdb::server
