#include "server/digest.h"

#include <openssl/sha.h>

namespace graspdb::server {

std::string Sha256(std::string_view content) {
  std::string out(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(),
         reinterpret_cast<unsigned char*>(out.data()));
  return out;
}

}  // namespace graspdb::server
