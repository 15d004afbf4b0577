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

// Reads messages, passes them to a worker, and writes its answers. Lives as long as an operation is
// pending. All handlers run on the one thread of the socket's context.
class RobotConnection : public std::enable_shared_from_this<RobotConnection> {
 public:
  // `workers` and `protocol` must outlive it.
  RobotConnection(asio::ip::tcp::socket socket, asio::thread_pool& workers, RobotProtocol& protocol,
                  std::chrono::milliseconds message_time);
  ~RobotConnection();

  // Its address.
  const std::string& robot() const { return robot_; }

  // Begins, and continues after each answer.
  void Continue();
  // Cancels pending operations; answers still being computed are not sent.
  void HangUp();

 private:
  void Receive();
  void Answer(std::size_t bytes);
  void Send(RobotReply reply);
  // Closes the connection once the robot has closed its end: closing with unread bytes would make
  // the system discard the answer.
  void DrainAndClose();
  void BeginDeadline();

  asio::ip::tcp::socket socket_;
  asio::thread_pool& workers_;
  RobotProtocol& protocol_;
  const std::chrono::milliseconds message_time_;
  const std::string robot_;
  asio::steady_timer deadline_;
  bool in_message_ = false;  // while the deadline runs
  std::string received_;
  std::array<char, 1024> next_ = {};
};

}  // namespace graspdb::client
