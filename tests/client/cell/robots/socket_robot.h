// A robot controller's end of a TCP connection, with the system's own calls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace graspdb::client {

class SocketRobot {
 public:
  // Connects to 127.0.0.1 from an address of this machine, such as 127.0.0.2; the test fails if
  // nothing listens there.
  explicit SocketRobot(std::uint16_t port, const char* from = "127.0.0.1");
  ~SocketRobot();
  SocketRobot(const SocketRobot&) = delete;
  SocketRobot& operator=(const SocketRobot&) = delete;

  void Send(const std::string& bytes);
  // Reads `bytes` bytes, or fewer if the peer closes or is silent for ten seconds.
  std::string Receive(std::size_t bytes);
  // Whether the peer closes within ten seconds, without another byte.
  bool IsHungUpOn() { return Receive(1).empty() && ended_; }

 private:
  int socket_ = -1;
  bool ended_ = false;
};

}  // namespace graspdb::client
