#include "server/requests/record_checks.h"

#include <openssl/sha.h>

#include <set>

#include "absl/strings/ascii.h"
#include "base/status_macros.h"
#include "program/base/uuid.h"
#include "storage/records/resource_name.h"

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

absl::Status CheckLabels(const google::protobuf::RepeatedPtrField<std::string>& labels,
                         std::string_view path) {
  std::set<std::string_view> known;
  for (int i = 0; i < labels.size(); ++i) {
    const std::string at = absl::StrCat(std::string(path), "[", i, "]");
    RETURN_IF_ERROR(AtField(at, storage::ValidateResourceId(labels[i])));
    if (!known.insert(labels[i]).second) return InvalidField(at, "is given twice");
  }
  return absl::OkStatus();
}

absl::Status CheckRelease(v1::ReleaseState release, std::string_view path) {
  if (v1::ReleaseState_IsValid(release)) return absl::OkStatus();
  return InvalidField(path, "is no release state");
}

}  // namespace graspdb::server
