#include "client/sdk/retry.h"

#include <algorithm>
#include <string>

#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"
#include "client/sdk/client.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"

namespace graspdb::client {
namespace {

// Longer delays are the caller's decision; that of a server of ours is 0.1 s.
constexpr absl::Duration kLongestDelay = absl::Seconds(30);

// Bounds of the random part of a pause. Of n clients that were refused together, one returns every
// span/n on average: of ten clients one each 0.1 s, about the time of a frame.
constexpr absl::Duration kShortestSpan = absl::Milliseconds(1);
constexpr absl::Duration kLongestSpan = absl::Seconds(1);

// Of gRPC, which refuses a call itself while it has no thread for it, as after a flood of calls.
constexpr absl::string_view kNoThread = "Server Threadpool Exhausted";
constexpr absl::Duration kNoThreadDelay = absl::Milliseconds(100);  // as of our servers

std::uint64_t RandomSeed() {
  std::random_device device;
  return std::uint64_t{device()} << 32U | device();
}

std::optional<absl::Duration> DelayOf(const google::rpc::Status& details) {
  for (const auto& detail : details.details()) {
    google::rpc::RetryInfo info;
    if (!detail.Is<google::rpc::RetryInfo>() || !detail.UnpackTo(&info)) continue;
    return absl::Seconds(info.retry_delay().seconds()) +
           absl::Nanoseconds(info.retry_delay().nanos());
  }
  return std::nullopt;
}

}  // namespace

std::optional<absl::Duration> BusyDelay(const absl::Status& status) {
  if (!absl::IsResourceExhausted(status)) return std::nullopt;
  if (status.message() == kNoThread) return kNoThreadDelay;
  const auto payload = status.GetPayload(kErrorDetails);
  google::rpc::Status details;
  if (!payload || !details.ParseFromString(std::string(*payload))) return std::nullopt;
  const std::optional<absl::Duration> delay = DelayOf(details);
  if (!delay || *delay < absl::ZeroDuration() || *delay > kLongestDelay) return std::nullopt;
  return delay;
}

Backoff::Backoff(absl::Duration first, absl::Duration longest)
    : Backoff(first, longest, RandomSeed()) {}

Backoff::Backoff(absl::Duration first, absl::Duration longest, std::uint64_t seed)
    : span_(std::min(first, longest)), longest_(longest), random_(seed) {}

absl::Duration Backoff::Next(absl::Duration least) {
  const double part = std::uniform_real_distribution<double>()(random_);
  const absl::Duration pause = least + part * span_;
  span_ = std::min(2 * span_, longest_);
  return pause;
}

std::optional<absl::Duration> BusyRetries::Next(const absl::Status& refused,
                                                MonotonicTime deadline) {
  const std::optional<absl::Duration> delay = BusyDelay(refused);
  if (!delay || left_ <= 0) return std::nullopt;
  --left_;
  if (!backoff_) backoff_.emplace(std::max(*delay, kShortestSpan), kLongestSpan);
  const absl::Duration pause = backoff_->Next(*delay);
  if (MonotonicTime::Now() + pause >= deadline) return std::nullopt;
  return pause;
}

}  // namespace graspdb::client
