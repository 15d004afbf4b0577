// Addresses of the own machine. In a header, so that the client library needs no other of ours.
#pragma once

#include <string_view>

namespace graspdb {

// Whether only programs on this machine can reach `host`. A name such as 127.example.org only looks
// like an address.
inline bool IsLoopback(std::string_view host) {
  if (host == "localhost" || host == "[::1]" || host == "::1") return true;
  return host.starts_with("127.") &&
         host.find_first_not_of("0123456789.") == std::string_view::npos;
}

}  // namespace graspdb
