#include "tests/client/cell/robots/socket_robot.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace graspdb::client {

SocketRobot::SocketRobot(std::uint16_t port, const char* from)
    : socket_(socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in own = {};
  own.sin_family = AF_INET;
  inet_pton(AF_INET, from, &own.sin_addr);
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(port);
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval timeout = {.tv_sec = 10, .tv_usec = 0};
  setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &timeout, sizeof(timeout));
  if (bind(socket_, reinterpret_cast<const sockaddr*>(&own), sizeof(own)) != 0 ||
      connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ADD_FAILURE() << "cannot connect to port " << port;
    close(std::exchange(socket_, -1));
  }
}

SocketRobot::~SocketRobot() {
  if (socket_ >= 0) close(socket_);
}

void SocketRobot::Send(const std::string& bytes) {
  std::size_t sent = 0;
  while (sent < bytes.size()) {
    const ssize_t now = send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (now <= 0) return;
    sent += static_cast<std::size_t>(now);
  }
}

std::string SocketRobot::Receive(std::size_t bytes) {
  std::string out(bytes, '\0');
  std::size_t received = 0;
  while (received < bytes) {
    const ssize_t now = recv(socket_, out.data() + received, bytes - received, 0);
    // A connection that is reset has ended, too.
    if (now == 0 || (now < 0 && errno == ECONNRESET)) ended_ = true;
    if (now <= 0) break;
    received += static_cast<std::size_t>(now);
  }
  out.resize(received);
  return out;
}

}  // namespace graspdb::client
