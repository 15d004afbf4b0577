#include "client/cell/robots/gri/gri_client.h"

#include <array>
#include <utility>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

GriClient::GriClient(asio::ip::tcp::iostream stream, std::chrono::milliseconds timeout)
    : stream_(std::move(stream)), timeout_(timeout) {}

absl::StatusOr<GriClient> GriClient::Connect(const std::string& host, std::uint16_t port,
                                             std::chrono::milliseconds timeout) {
  asio::ip::tcp::iostream stream;
  stream.expires_after(timeout);
  stream.connect(host, std::to_string(port));
  if (!stream) {
    return absl::UnavailableError(absl::StrCat("no GRI server at ", host, ":", port, " (",
                                               stream.error().message(), "); start graspdb-cell"));
  }
  asio::error_code refused;  // then answers only have a higher latency
  stream.socket().set_option(asio::ip::tcp::no_delay(true), refused);
  return GriClient(std::move(stream), timeout);
}

absl::StatusOr<GriResponse> GriClient::Call(const GriRequest& request) {
  const auto bytes = GriBytes(request);
  std::array<std::uint8_t, kGriResponseBytes> answer = {};
  stream_.expires_after(timeout_);
  stream_.write(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  stream_.flush();
  stream_.read(reinterpret_cast<char*>(answer.data()), answer.size());
  if (!stream_) {
    return absl::UnavailableError(
        absl::StrCat("no answer from the cell's agent (", stream_.error().message(), ")"));
  }
  return ParseGriResponse(answer);
}

}  // namespace graspdb::client
