#include "server/upload_expiry.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>

#include "program/log_field.h"

namespace graspdb::server {
namespace {

// As documented in the contract.
constexpr absl::Duration kOpenUploadAge = absl::Hours(7 * 24);
constexpr absl::Duration kCommittedUploadAge = absl::Hours(30 * 24);
constexpr std::chrono::hours kExpiryInterval{1};

}  // namespace

void UploadExpiry::Run(storage::Uploads& uploads, absl::Time wall, Clock::time_point monotonic) {
  if (last_ && monotonic - *last_ < kExpiryInterval) return;
  now_ = last_ ? std::min(wall, now_ + absl::FromChrono(monotonic - *last_)) : wall;
  last_ = monotonic;
  const auto deleted = uploads.DeleteOlderThan(now_ - kOpenUploadAge, now_ - kCommittedUploadAge);
  if (!deleted.ok()) {
    spdlog::error("event=upload_expiry error={}",
                  LogField(std::string(deleted.status().message())));
    return;
  }
  for (const std::string& name : *deleted) {
    spdlog::warn("event=upload_expired name={}", LogField(name));
  }
}

}  // namespace graspdb::server
