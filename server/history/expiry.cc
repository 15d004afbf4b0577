#include "server/history/expiry.h"

#include <google/protobuf/util/time_util.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <string>

#include "program/log/log_field.h"
#include "storage/history/history.h"
#include "storage/uploads/uploads.h"

namespace graspdb::server {
namespace {

// As documented in the contract.
constexpr absl::Duration kOpenUploadAge = absl::Hours(7 * 24);
constexpr absl::Duration kCommittedUploadAge = absl::Hours(30 * 24);
constexpr std::chrono::hours kExpiryInterval{1};
// A clock that makes all of the history old, by more than this, is taken for wrong: a server that
// was off for so long keeps the history until it has run for the time that it is kept.
constexpr absl::Duration kLongestOff = absl::Hours(7 * 24);

// The time of the last change; nullopt without one.
std::optional<absl::Time> LastChangeTime(const storage::Catalogue& catalogue) {
  const std::int64_t before = std::max<std::int64_t>(0, catalogue.revision() - 1);
  const auto changes = catalogue.ReadChanges(before, 1);
  if (!changes.ok() || changes->empty()) return std::nullopt;
  using google::protobuf::util::TimeUtil;
  return absl::FromUnixNanos(TimeUtil::TimestampToNanoseconds(changes->front().time()));
}

}  // namespace

absl::Time Expiry::TimeAtStart(const storage::Catalogue& catalogue, absl::Time wall) const {
  const auto last_change = LastChangeTime(catalogue);
  if (!last_change || wall - *last_change <= history_kept_ + kLongestOff) return wall;
  spdlog::info("event=expiry_from_last_change time={}", absl::FormatTime(*last_change));
  return *last_change;
}

void Expiry::Run(storage::Catalogue& catalogue, absl::Time wall, Clock::time_point monotonic) {
  if (start_ && monotonic - last_ < kExpiryInterval) return;
  if (!start_) start_ = Start{TimeAtStart(catalogue, wall), monotonic};
  now_ = std::min(wall, start_->wall + absl::FromChrono(monotonic - start_->monotonic));
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
