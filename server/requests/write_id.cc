#include "server/requests/write_id.h"

#include <openssl/sha.h>

#include "absl/strings/ascii.h"
#include "program/base/uuid.h"
#include "server/base/errors.h"

namespace graspdb::server {

absl::StatusOr<std::string> WriteIdFromProto(std::string_view request_id) {
  if (!request_id.empty() && !IsUuid4(request_id)) {
    return InvalidField("request_id", "must be a UUID of version 4, or empty");
  }
  std::string out(request_id);
  absl::AsciiStrToLower(&out);
  return out;
}

std::string Sha256(std::string_view content) {
  std::string out(SHA256_DIGEST_LENGTH, '\0');
  SHA256(reinterpret_cast<const unsigned char*>(content.data()), content.size(),
         reinterpret_cast<unsigned char*>(out.data()));
  return out;
}

}  // namespace graspdb::server
