#include "client/cell/agent/refusal.h"

#include "absl/strings/str_cat.h"
#include "client/sdk/retry.h"

namespace graspdb::client {

absl::Status Refusal(const absl::Status& answered) {
  if (answered.ok() || absl::IsUnavailable(answered) || absl::IsDeadlineExceeded(answered)) {
    return answered;
  }
  if (BusyDelay(answered)) return absl::UnavailableError(answered.message());
  return absl::DataLossError(
      absl::StrCat(absl::StatusCodeToString(answered.code()), ": ", answered.message()));
}

}  // namespace graspdb::client
