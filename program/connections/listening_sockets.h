// TCP sockets that listen.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "program/connections/file_descriptor.h"
#include "program/connections/listen_address.h"

namespace graspdb {

// One for each address of a host. They do not block.
struct ListeningSockets {
  std::vector<FileDescriptor> sockets;
  std::uint16_t port = 0;  // of all
};

// Listens at every address of the host that this machine has; for port 0 at the same free port.
// 0.0.0.0 and [::] both stand for all addresses of IPv4 and IPv6. UNAVAILABLE, with the reason
// alone, where that is none, or another process has the port at one of them.
absl::StatusOr<ListeningSockets> ListenAt(const ListenAddress& address);

}  // namespace graspdb
