#include "client/sdk/connection.h"

#include <algorithm>
#include <chrono>
#include <system_error>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/string_view.h"
#include "client/sdk/client.h"
#include "google/rpc/error_details.pb.h"
#include "google/rpc/status.pb.h"
#include "program/connections/proxy.h"

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

// The first delay between two attempts to connect, and the longest, to which it grows by 1.6 with
// each. gRPC's own 120 s keep a cell without a server for up to 2 minutes after that is back.
constexpr int kFirstReconnectMs = 100;
constexpr int kLongestReconnectMs = 1'000;
// For an attempt: TCP, TLS, and the server's first HTTP/2 frame. TCP repeats a lost packet after 1
// and 3 s, so a cable that is plugged in is noticed after 2 s at the latest. In spite of its name
// the option is not a minimum of the delay.
constexpr int kConnectMs = 4'000;
// Milliseconds without a message during a call after which the server gets a ping, at least 10 s
// (server/server.cc), and after which the connection is closed if the ping or sent data
// are not acknowledged (TCP_USER_TIMEOUT). Without, TCP repeats data up to 2 minutes after the
// power is back at the server.
constexpr int kClientKeepaliveMs = 20'000;
constexpr int kClientKeepaliveTimeoutMs = 10'000;

// Between two checks whether the client is destroyed.
constexpr std::chrono::milliseconds kCheck(100);

}  // namespace

Reconnection::Reconnection(std::shared_ptr<grpc::Channel> channel) : channel_(std::move(channel)) {}

Reconnection::~Reconnection() {
  stopping_ = true;
  if (thread_.joinable()) thread_.join();
}

bool Reconnection::IsConnected() const {
  return channel_->GetState(/*try_to_connect=*/false) == GRPC_CHANNEL_READY;
}

void Reconnection::Begin() {
  const std::scoped_lock lock(mutex_);
  if (waiting_) return;
  if (thread_.joinable()) thread_.join();
  try {
    thread_ = std::thread([this] { Wait(); });
    waiting_ = true;
  } catch (const std::system_error&) {
    // As described: the connection then takes longer, or the next failed call begins.
  }
}

void Reconnection::Wait() {
  while (!stopping_) {
    const grpc_connectivity_state state = channel_->GetState(/*try_to_connect=*/true);
    if (state == GRPC_CHANNEL_READY) break;
    channel_->WaitForStateChange(state, std::chrono::system_clock::now() + kCheck);
  }
  const std::scoped_lock lock(mutex_);
  waiting_ = false;
}

grpc::ChannelArguments ChannelArgumentsFor(const std::string& server) {
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kFirstReconnectMs);
  arguments.SetInt(GRPC_ARG_MAX_RECONNECT_BACKOFF_MS, kLongestReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kConnectMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIME_MS, kClientKeepaliveMs);
  arguments.SetInt(GRPC_ARG_KEEPALIVE_TIMEOUT_MS, kClientKeepaliveTimeoutMs);
  if (IsLocalTarget(server)) arguments.SetInt(GRPC_ARG_ENABLE_HTTP_PROXY, 0);
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetMaxSendMessageSize(-1);
  return arguments;
}

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
