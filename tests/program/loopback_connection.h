// Connections to a port of this machine.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <sys/socket.h>

#include <cstdint>
#include <utility>

#include "program/connections/file_descriptor.h"

namespace graspdb::testing {

// Addresses of this machine.
inline constexpr std::uint32_t kOneAddress = INADDR_LOOPBACK;
inline constexpr std::uint32_t kAnotherAddress = INADDR_LOOPBACK + 1;

inline sockaddr_in AddressAt(std::uint32_t host, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  out.sin_addr.s_addr = htonl(host);
  return out;
}

inline bool Connects(const FileDescriptor& connection, std::uint16_t port) {
  const sockaddr_in to = AddressAt(kOneAddress, port);
  return connect(connection.number(), reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0;
}

inline FileDescriptor ConnectTo(std::uint16_t port, std::uint32_t from = kOneAddress) {
  FileDescriptor out(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const sockaddr_in own = AddressAt(from, 0);
  EXPECT_EQ(bind(out.number(), reinterpret_cast<const sockaddr*>(&own), sizeof(own)), 0);
  if (!Connects(out, port)) out.Close();
  return out;
}

}  // namespace graspdb::testing
