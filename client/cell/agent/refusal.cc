#include "client/cell/agent/refusal.h"

#include "absl/strings/str_cat.h"

namespace graspdb::client {

absl::Status Refusal(const absl::Status& answered) {
  if (answered.ok() || absl::IsUnavailable(answered) || absl::IsDeadlineExceeded(answered) ||
      absl::IsResourceExhausted(answered)) {
    return answered;
  }
  return absl::DataLossError(
      absl::StrCat(absl::StatusCodeToString(answered.code()), ": ", answered.message()));
}

}  // namespace graspdb::client
