// A robot controller's end of a TCP connection, by the system's own calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace graspdb::client {

class SocketRobot {
 public:
  // To 127.0.0.1; the test fails where nobody listens.
  explicit SocketRobot(std::uint16_t port);
  ~SocketRobot();
  SocketRobot(const SocketRobot&) = delete;
  SocketRobot& operator=(const SocketRobot&) = delete;

  void Send(const std::string& bytes);
  // So many bytes, or those before the other side hung up or was silent for ten seconds.
  std::string Receive(std::size_t bytes);
  // Whether the other side hangs up, within ten seconds, without a byte more.
  bool IsHungUpOn() { return Receive(1).empty() && ended_; }

 private:
  int socket_ = -1;
  bool ended_ = false;
};

}  // namespace graspdb::client
