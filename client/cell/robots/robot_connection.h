// One robot's connection.
#pragma once

#include <array>
#include <asio/ip/tcp.hpp>
#include <asio/steady_timer.hpp>
#include <asio/thread_pool.hpp>
#include <memory>
#include <string>

#include "client/cell/robots/robot_server.h"

namespace graspdb::client {

// Reads messages, has them answered by a worker, and writes the answers. It lives as long as
// something is under way. All handlers are run by the one thread of the socket's context.
class RobotConnection : public std::enable_shared_from_this<RobotConnection> {
 public:
  // `workers` and `protocol` must outlive it.
  RobotConnection(asio::ip::tcp::socket socket, asio::thread_pool& workers, RobotProtocol& protocol,
                  std::chrono::milliseconds message_time);
  ~RobotConnection();

  void Begin() { Continue(); }
  // Whatever is under way ends; what a worker is about to answer is not sent.
  void HangUp();

 private:
  void Continue();
  void Receive();
  void Answer(std::size_t bytes);
  void Send(RobotReply reply);
  // Hangs up when the robot has read what it was told: where bytes of it are left unread, the
  // system would take the answer back.
  void SayGoodbye();
  void BeginDeadline();

  asio::ip::tcp::socket socket_;
  asio::thread_pool& workers_;
  RobotProtocol& protocol_;
  const std::chrono::milliseconds message_time_;
  const std::string robot_;
  asio::steady_timer deadline_;
  bool in_message_ = false;  // and the deadline runs
  std::string received_;
  std::array<char, 1024> next_ = {};
};

}  // namespace graspdb::client
