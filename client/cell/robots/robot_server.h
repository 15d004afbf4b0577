// Robots on TCP, whatever protocol they speak.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "absl/status/statusor.h"

namespace graspdb::client {

// What a robot is told.
struct RobotReply {
  std::string bytes;
  bool hang_up = false;  // after they are sent: what follows cannot be understood
};

// Messages of robots and their answers. Implementations are thread-safe.
class RobotProtocol {
 public:
  virtual ~RobotProtocol() = default;

  // Of how many bytes the first message in `received` is; 0: more must come. What can never become
  // a message is one, too: Answer says what is wrong with it.
  virtual std::size_t MessageBytes(std::string_view received) const = 0;

  // The answer to one message, which may take as long as a job. `robot` is its address.
  virtual RobotReply Answer(const std::string& robot, std::string_view message) = 0;
};

struct RobotServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 0;  // 0: any that is free
  // A message that has begun must have come within this time.
  std::chrono::milliseconds message_time{5000};
  // More robots than these at once are turned away.
  std::size_t most_connections = 256;
  // So many messages are answered at once, others wait.
  std::size_t workers = 16;
};

// Listens to robots. Each is answered in the order of its messages, and does not wait for others
// but for workers. Connections that idle stay. The log tells who comes and goes.
class RobotServer {
 public:
  // `protocol` must outlive it. INVALID_ARGUMENT when the address is none, UNAVAILABLE when it
  // cannot be listened on, RESOURCE_EXHAUSTED when there are no threads left.
  static absl::StatusOr<std::unique_ptr<RobotServer>> Start(RobotProtocol& protocol,
                                                            const RobotServerOptions& options);
  // Hangs up on everybody, and waits for answers that are being made.
  ~RobotServer();
  RobotServer(const RobotServer&) = delete;
  RobotServer& operator=(const RobotServer&) = delete;

  std::uint16_t port() const;

 private:
  class Listener;
  explicit RobotServer(std::unique_ptr<Listener> listener);

  std::unique_ptr<Listener> listener_;
};

}  // namespace graspdb::client
