// Where a program listens.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb {

struct ListenAddress {
  std::string host;
  std::uint16_t port = 0;  // 0: any that is free
};

// `text` is what was given to `flag`, HOST:PORT. INVALID_ARGUMENT when it is none.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& flag, const std::string& text);

// Whether only programs on this machine can reach it. A name such as 127.example.org only looks
// like an address.
bool IsLoopback(const std::string& host);

}  // namespace graspdb
