#include "server/requests/record_checks.h"

#include <set>

#include "base/status_macros.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {

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
