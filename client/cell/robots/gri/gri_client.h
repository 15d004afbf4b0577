// A client of the Generic Robot Interface.
#pragma once

// clang-format off
// Before Asio, which otherwise allocates and frees with different functions in different files.
#include <version>
#include <asio/ip/tcp.hpp>
// clang-format on
#include <chrono>
#include <cstdint>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/robots/gri/gri_message.h"

namespace graspdb::client {

// A connection to a cell's agent. Not thread-safe.
class GriClient {
 public:
  // An answer that takes longer than `timeout` is an error. UNAVAILABLE if nothing listens there.
  static absl::StatusOr<GriClient> Connect(const std::string& host, std::uint16_t port,
                                           std::chrono::milliseconds timeout);

  // UNAVAILABLE when the connection is lost or the answer times out: then reconnect.
  // INVALID_ARGUMENT for a malformed answer.
  absl::StatusOr<GriResponse> Call(const GriRequest& request);

 private:
  GriClient(asio::ip::tcp::iostream stream, std::chrono::milliseconds timeout);

  asio::ip::tcp::iostream stream_;
  std::chrono::milliseconds timeout_;
};

}  // namespace graspdb::client
