#include "server/write_id.h"

#include "absl/strings/ascii.h"
#include "program/uuid.h"
#include "server/errors.h"

namespace graspdb::server {

absl::StatusOr<std::string> WriteIdFromProto(std::string_view request_id) {
  if (!request_id.empty() && !IsUuid4(request_id)) {
    return InvalidField("request_id", "must be a UUID of version 4, or empty");
  }
  std::string out(request_id);
  absl::AsciiStrToLower(&out);
  return out;
}

}  // namespace graspdb::server
