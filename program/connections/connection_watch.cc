#include "program/connections/connection_watch.h"

#include <netinet/in.h>
// After <netinet/in.h>, which it needs. <netinet/tcp.h> has an older tcp_info, without bytes.
#include <linux/tcp.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <optional>
#include <utility>

#include "program/connections/peer_address.h"
#include "program/log/log_field.h"

namespace graspdb {
namespace {

// In which abandoned calls are counted.
constexpr std::chrono::seconds kWindow{1};
// So many more of an address for each of its connections: hundreds of cells behind one address may
// give up at once.
constexpr int kAbandonedByConnection = 8;
// How long an address cannot connect after one of its connections was ended.
constexpr std::chrono::seconds kBar{10};
// Between two looks at what connections receive.
constexpr std::chrono::milliseconds kCheckInterval{200};
// Messages and calls of a connection between two of them, from which on it is suspected.
constexpr int kManyMessages = 500;
// A message may take this long to arrive, even if the process takes too much memory.
constexpr std::chrono::seconds kLongMessage{5};
// What a connection has to receive until it is suspected.
constexpr std::uint64_t kLittleBytes = 1U << 20U;

// Bytes that the connection has received; 0 if there is none.
std::uint64_t ReceivedBy(int descriptor) {
  tcp_info info{};
  socklen_t size = sizeof(info);
  if (getsockopt(descriptor, IPPROTO_TCP, TCP_INFO, &info, &size) != 0) return 0;
  return info.tcpi_bytes_received;
}

}  // namespace

ConnectionWatch::ConnectionWatch(const Limits& limits, std::function<std::size_t()> memory_bytes)
    : limits_(limits), memory_bytes_(std::move(memory_bytes)) {}

bool ConnectionWatch::Add(int connection, const std::string& peer, Clock::time_point now) {
  if (peer.empty()) return true;  // closed already
  absl::MutexLock lock(&mutex_);
  if (now >= next_forgetting_) Forget(now);
  const auto address = addresses_.find(NetworkOfPeer(peer));
  if (address != addresses_.end() && now < address->second.barred_until) return false;
  Connection added;
  added.descriptor = connection;
  connections_[peer] = added;
  return true;
}

void ConnectionWatch::NoteMessage(const std::string& peer) {
  absl::MutexLock lock(&mutex_);
  const auto found = connections_.find(peer);
  if (found != connections_.end()) ++found->second.messages;
}

void ConnectionWatch::NoteAbandoned(const std::string& peer, Clock::time_point now) {
  absl::MutexLock lock(&mutex_);
  const auto found = connections_.find(peer);
  if (found == connections_.end()) return;
  const std::string name = NetworkOfPeer(peer);
  Address& address = addresses_[name];
  if (now >= address.window_end) BeginWindow(name, address, now);
  ++found->second.abandoned;
  ++address.abandoned;
  const int connections = address.connections;
  if (address.abandoned <= limits_.abandoned_calls + kAbandonedByConnection * connections) return;
  address.barred_until = now + kBar;
  const int least = address.abandoned / (2 * connections);
  std::erase_if(connections_, [&](const auto& entry) {
    const auto& [client, connection] = entry;
    const bool ends = connection.abandoned > least && NetworkOfPeer(client) == name;
    if (ends) End(client, connection, "it abandoned many calls; its address is barred for 10 s");
    return ends;
  });
  BeginWindow(name, address, now);
}

void ConnectionWatch::BeginWindow(const std::string& name, Address& address,
                                  Clock::time_point now) {
  address.window_end = now + kWindow;
  address.abandoned = 0;
  address.connections = 0;
  for (auto& [peer, connection] : connections_) {
    if (NetworkOfPeer(peer) != name) continue;
    connection.abandoned = 0;
    ++address.connections;
  }
}

void ConnectionWatch::Check(Clock::time_point now) {
  absl::MutexLock lock(&mutex_);
  if (limits_.memory_bytes == 0 || now < next_check_) return;
  next_check_ = now + kCheckInterval;
  if (memory_bytes_() <= limits_.memory_bytes) return;
  const std::string* const peer = Suspect(now);
  if (peer == nullptr) return;
  // Its memory is free at once, but the process gives it back within ten seconds.
  addresses_[NetworkOfPeer(*peer)].barred_until = now + kBar;
  End(*peer, connections_[*peer],
      "the memory is used up, and it takes most; its address is barred for 10 s");
  connections_.erase(std::string(*peer));
}

const std::string* ConnectionWatch::Suspect(Clock::time_point now) {
  const std::string* receives_most = nullptr;
  const std::string* sends_most = nullptr;
  std::uint64_t most_bytes = 0;
  int most_messages = kManyMessages;
  for (auto& [peer, connection] : connections_) {
    const std::uint64_t received = ReceivedBy(connection.descriptor);
    const int messages = std::exchange(connection.messages, 0);
    if (messages > 0) {
      connection.received_before = received;
      connection.waits_since = now;
    }
    if (messages > most_messages) {
      most_messages = messages;
      sends_most = &peer;
    }
    const std::uint64_t bytes = received - connection.received_before;
    const bool is_suspect = bytes > limits_.message_bytes + kLittleBytes ||
                            (bytes > kLittleBytes && now - connection.waits_since > kLongMessage);
    if (!is_suspect || bytes <= most_bytes) continue;
    most_bytes = bytes;
    receives_most = &peer;
  }
  return sends_most != nullptr ? sends_most : receives_most;
}

// Whoever closes a connection need not report it: its descriptor has no peer then, or another one.
void ConnectionWatch::Forget(Clock::time_point now) {
  next_forgetting_ = now + kWindow;
  std::erase_if(connections_,
                [](const auto& entry) { return PeerOf(entry.second.descriptor) != entry.first; });
  std::erase_if(addresses_, [now](const auto& entry) {
    return now >= entry.second.window_end && now >= entry.second.barred_until;
  });
}

void ConnectionWatch::End(const std::string& peer, const Connection& connection,
                          std::string_view reason) {
  if (PeerOf(connection.descriptor) != peer) return;
  shutdown(connection.descriptor, SHUT_RDWR);
  ++ended_;
  if (const std::optional<std::int64_t> count = ends_.Count()) {
    spdlog::warn("event=connections_ended count={} peer={} reason={}", *count, LogField(peer),
                 LogField(reason));
  }
}

std::int64_t ConnectionWatch::ended_count() const {
  absl::MutexLock lock(&mutex_);
  return ended_;
}

}  // namespace graspdb
