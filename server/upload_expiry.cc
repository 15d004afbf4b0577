#include "server/upload_expiry.h"

#include <spdlog/spdlog.h>

#include <string>

#include "absl/time/clock.h"
#include "program/log_field.h"

namespace graspdb::server {
namespace {

// As documented in the contract.
constexpr absl::Duration kOpenUploadAge = absl::Hours(7 * 24);
constexpr absl::Duration kCommittedUploadAge = absl::Hours(30 * 24);
constexpr absl::Duration kExpiryInterval = absl::Hours(1);

}  // namespace

void UploadExpiry::Run(storage::Uploads& uploads) {
  const absl::Time now = absl::Now();
  if (now < next_) return;
  next_ = now + kExpiryInterval;
  const auto deleted = uploads.DeleteOlderThan(now - kOpenUploadAge, now - kCommittedUploadAge);
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
