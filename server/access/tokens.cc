#include "server/access/tokens.h"

#include <openssl/rand.h>
#include <openssl/sha.h>

#include <array>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace graspdb::server {

std::string NewToken() {
  std::array<unsigned char, 32> bits;
  if (RAND_bytes(bits.data(), static_cast<int>(bits.size())) != 1) return "";
  return absl::StrCat("graspdb_", absl::WebSafeBase64Escape(absl::string_view(
                                      reinterpret_cast<const char*>(bits.data()), bits.size())));
}

std::string HashToken(std::string_view token) {
  std::string out(kTokenHashBytes, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(token.data()), token.size(),
         reinterpret_cast<unsigned char*>(out.data()));
  return out;
}

}  // namespace graspdb::server
