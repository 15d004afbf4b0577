// TCP server for robots, independent of the protocol.
#pragma once

#include <asio/ip/address.hpp>
#include <asio/ip/network_v4.hpp>
#include <asio/ip/network_v6.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::client {

// Networks from which robots may connect.
class AllowList {
 public:
  // Networks such as "10.3.0.0/24" and "fd00::/8", and single addresses; none: all addresses are
  // allowed. INVALID_ARGUMENT for another text.
  static absl::StatusOr<AllowList> Parse(const std::vector<std::string>& networks);

  // IPv4 addresses may be mapped to IPv6, as a socket for both has them.
  bool Allows(const asio::ip::address& address) const;

 private:
  std::vector<asio::ip::network_v4> v4_;
  std::vector<asio::ip::network_v6> v6_;
};

// A reply to a robot.
struct RobotReply {
  std::string bytes;
  bool hang_up = false;  // close after sending: the bytes that follow cannot be parsed
};

// Splits and answers messages of robots. Implementations are thread-safe.
class RobotProtocol {
 public:
  virtual ~RobotProtocol() = default;

  // Size of the first message in `received`; 0: incomplete. Invalid bytes count as a message, too:
  // Answer reports the error.
  virtual std::size_t MessageBytes(std::string_view received) const = 0;

  // The answer to one message; may take as long as a job. `robot` is its address. After an
  // exception the connection is closed.
  virtual RobotReply Answer(const std::string& robot, std::string_view message) = 0;
};

struct RobotServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any that is free
  // Networks ("10.3.0.0/24") and addresses from which robots may connect; empty: all.
  std::vector<std::string> allow = {};
  // A message must be complete within this time after its first byte.
  std::chrono::milliseconds message_time{5000};
  // Further connections are rejected.
  std::size_t max_connections = 256;
  // Of these from one address, so that a robot that closes none leaves some for the others.
  std::size_t max_connections_per_robot = 128;
  // Number of messages answered in parallel; others wait.
  std::size_t workers = 16;
};

// Listens for robots. Each robot's messages are answered in order; robots wait for a free worker,
// not for each other. Idle connections stay open. Connects and disconnects are logged.
class RobotServer {
 public:
  // `protocol` must outlive it. INVALID_ARGUMENT for an invalid address or network, UNAVAILABLE
  // when it cannot listen there, RESOURCE_EXHAUSTED when there are no threads left.
  static absl::StatusOr<std::unique_ptr<RobotServer>> Start(RobotProtocol& protocol,
                                                            const RobotServerOptions& options);
  // Closes all connections, and waits for answers in progress.
  ~RobotServer();
  RobotServer(const RobotServer&) = delete;
  RobotServer& operator=(const RobotServer&) = delete;

  std::uint16_t port() const;

  // Open connections. Waits for the thread that accepts them.
  std::size_t connection_count() const;

 private:
  class Listener;
  explicit RobotServer(std::unique_ptr<Listener> listener);

  std::unique_ptr<Listener> listener_;
};

}  // namespace graspdb::client
