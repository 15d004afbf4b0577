// Ends connections that take from the others what gRPC does not limit.
//
// Debian's gRPC 1.51 queues calls that are reset at once (CVE-2023-44487), and keeps headers
// without end (CVE-2024-27316), until the memory of the machine is used up. Neither holds a stream
// or a place of a call. docs/adr/0036-connections-are-accepted-by-the-programs.md
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <unordered_map>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "program/log/log_interval.h"

namespace graspdb {

// Knows the open connections by their clients' names in grpc::ServerContext::peer(). Thread-safe.
class ConnectionWatch {
 public:
  using Clock = std::chrono::steady_clock;

  struct Limits {
    // Calls that one address may abandon within a second, and eight more for each of its
    // connections. An honest client abandons at most those that it has open, up to 128.
    int abandoned_calls = 500;
    std::size_t memory_bytes = 0;   // of the process; 0: any
    std::size_t message_bytes = 0;  // of the largest message
  };
  // `memory_bytes`: of the process, now.
  ConnectionWatch(const Limits& limits, std::function<std::size_t()> memory_bytes);

  // Knows the connection from now on. False if another one of its address was ended within 10 s.
  bool Add(int connection, const std::string& peer, Clock::time_point now = Clock::now());
  // A call or another message has arrived.
  void NoteMessage(const std::string& peer);
  // A call has no readable message, or its client did not wait for its end. Beyond the limit, ends
  // the connections of the address that contributed.
  void NoteAbandoned(const std::string& peer, Clock::time_point now = Clock::now());
  // While the process takes more than its memory: ends the connection with most messages, if it
  // sends thousands a second; else the one that received most since its last message, if that is
  // more than a message, or it has taken long for it. To be called every 200 ms or more often.
  void Check(Clock::time_point now = Clock::now());

  std::int64_t ended_count() const;

 private:
  struct Connection {
    int descriptor = -1;
    int abandoned = 0;                  // in the window of its address
    int messages = 1;                   // since the last check
    std::uint64_t received_before = 0;  // bytes, until the last message
    Clock::time_point waits_since;      // for a message
  };
  struct Address {
    int connections = 0;  // when the window began
    int abandoned = 0;    // in the window
    Clock::time_point window_end;
    Clock::time_point barred_until;
  };

  // The client of the connection to end; null: none is suspected.
  const std::string* Suspect(Clock::time_point now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Forget(Clock::time_point now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void BeginWindow(const std::string& name, Address& address, Clock::time_point now)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void End(const std::string& peer, const Connection& connection, std::string_view reason)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const Limits limits_;
  const std::function<std::size_t()> memory_bytes_;
  mutable absl::Mutex mutex_;
  std::unordered_map<std::string, Connection> connections_ ABSL_GUARDED_BY(mutex_);  // by peer
  std::unordered_map<std::string, Address> addresses_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point next_check_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point next_forgetting_ ABSL_GUARDED_BY(mutex_);
  std::int64_t ended_ ABSL_GUARDED_BY(mutex_) = 0;
  LogInterval ends_;
};

}  // namespace graspdb
