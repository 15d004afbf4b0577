// When a call that a busy server has refused is sent again.
//
// gRPC's own retries (client.cc) repeat calls after UNAVAILABLE. They are not used here: they know
// no RetryInfo, so that they would repeat a message that is too large (RESOURCE_EXHAUSTED as well),
// they end after five attempts, and a server's pushback (grpc-retry-pushback-ms) has no jitter.
#pragma once

#include <cstdint>
#include <optional>
#include <random>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// The delay of a RESOURCE_EXHAUSTED (google.rpc.RetryInfo, or of gRPC itself without a thread for
// the call) that a client has returned. None for other errors and where a retry is of no use: the
// message is too large, a disk or a quota is full, or the delay is not within 0 to 30 s.
std::optional<absl::Duration> BusyDelay(const absl::Status& status);

// Pauses between attempts, which grow and differ between clients: those that were refused together
// do not come back together. For one thread.
class Backoff {
 public:
  // `first` is positive.
  Backoff(absl::Duration first, absl::Duration longest);
  // The same seed gives the same pauses.
  Backoff(absl::Duration first, absl::Duration longest, std::uint64_t seed);

  // `least` and a random part of a span, which is `first` at first and doubles with every call up
  // to `longest`.
  absl::Duration Next(absl::Duration least);

 private:
  absl::Duration span_;
  const absl::Duration longest_;
  std::mt19937_64 random_;
};

// The retries of one call. For one thread.
class BusyRetries {
 public:
  explicit BusyRetries(int limit) : left_(limit) {}

  // The pause before the call is sent again. None where `refused` is final: BusyDelay has none, the
  // limit is reached, or the deadline is nearer than the pause.
  std::optional<absl::Duration> Next(const absl::Status& refused, MonotonicTime deadline);

 private:
  int left_;
  std::optional<Backoff> backoff_;
};

}  // namespace graspdb::client
