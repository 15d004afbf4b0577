#include "server/expiry.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>

#include "program/log_field.h"
#include "storage/history.h"
#include "storage/uploads.h"

namespace graspdb::server {
namespace {

// As documented in the contract.
constexpr absl::Duration kOpenUploadAge = absl::Hours(7 * 24);
constexpr absl::Duration kCommittedUploadAge = absl::Hours(30 * 24);
constexpr std::chrono::hours kExpiryInterval{1};

}  // namespace

void Expiry::Run(storage::Catalogue& catalogue, absl::Time wall, Clock::time_point monotonic) {
  if (last_ && monotonic - *last_ < kExpiryInterval) return;
  now_ = last_ ? std::min(wall, now_ + absl::FromChrono(monotonic - *last_)) : wall;
  last_ = monotonic;
  DeleteUploads(catalogue);
  PurgeHistory(catalogue);
}

void Expiry::DeleteUploads(storage::Catalogue& catalogue) const {
  const auto deleted =
      catalogue.uploads().DeleteOlderThan(now_ - kOpenUploadAge, now_ - kCommittedUploadAge);
  if (!deleted.ok()) {
    spdlog::error("event=upload_expiry error={}",
                  LogField(std::string(deleted.status().message())));
    return;
  }
  for (const std::string& name : *deleted) {
    spdlog::warn("event=upload_expired name={}", LogField(name));
  }
}

void Expiry::PurgeHistory(storage::Catalogue& catalogue) const {
  const auto purged = catalogue.history().PurgeOlderThan(now_ - history_kept_);
  if (!purged.ok()) {
    spdlog::error("event=history_expiry error={}",
                  LogField(std::string(purged.status().message())));
    return;
  }
  for (const std::string& name : *purged) {
    spdlog::info("event=deleted_object_purged name={}", LogField(name));
  }
}

}  // namespace graspdb::server
