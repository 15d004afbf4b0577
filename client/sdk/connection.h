// How a client connects, connects again after a call has failed, and repeats calls; internal to the
// client library.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/support/channel_arguments.h>

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "absl/time/time.h"
#include "program/base/monotonic_time.h"

namespace graspdb::client {

// A thread that waits for a channel's next connection, as a call does that has to wait for it.
//
// gRPC reads from the sockets of a channel in threads that wait for an event of that channel, and
// every 5 s. Once an attempt to connect has failed, calls do not wait but fail until another
// attempt succeeds; without a waiting thread, each message of the server takes such an attempt 5 s.
// With TLS it is over before it succeeds (gRPC's issue 33593). Thread-safe.
class Reconnection {
 public:
  explicit Reconnection(std::shared_ptr<grpc::Channel> channel);
  // Takes up to 0.1 s; longer by as much as the wall clock is set back meanwhile (gRPC 32176).
  ~Reconnection();
  Reconnection(const Reconnection&) = delete;
  Reconnection& operator=(const Reconnection&) = delete;

  bool IsConnected() const;
  // Starts the thread if it does not run; it ends with a connection. Without effect where there are
  // no more threads, or where the thread is just ending: to be called after each call that fails.
  void Begin();

 private:
  void Wait();

  const std::shared_ptr<grpc::Channel> channel_;
  std::atomic<bool> stopping_ = false;
  std::mutex mutex_;  // of the next two
  bool waiting_ = false;
  std::thread thread_;
};

// Reconnection, keepalive, proxy and message sizes of a channel to `server` (HOST:PORT); retries
// are the caller's. Thread-safe.
grpc::ChannelArguments ChannelArgumentsFor(const std::string& server);

// When a call that a busy server has refused is sent again.
//
// gRPC's own retries (client.cc) repeat calls after UNAVAILABLE. They are not used here: they know
// no RetryInfo, so that they would repeat a message that is too large (RESOURCE_EXHAUSTED as well),
// they end after five attempts, and a server's pushback (grpc-retry-pushback-ms) has no jitter.

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
