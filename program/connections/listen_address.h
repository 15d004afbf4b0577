// The address on which a program listens.
#pragma once

#include <cstdint>
#include <string>

#include "absl/status/statusor.h"

namespace graspdb {

struct ListenAddress {
  std::string host;
  std::uint16_t port = 0;  // 0: any free port
};

// Parses `text`, the HOST:PORT given to `flag`. INVALID_ARGUMENT if it is invalid.
absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& flag, const std::string& text);

}  // namespace graspdb
