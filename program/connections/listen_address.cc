#include "program/connections/listen_address.h"

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"

namespace graspdb {

absl::StatusOr<ListenAddress> ParseListenAddress(const std::string& flag, const std::string& text) {
  const std::size_t colon = text.rfind(':');
  int port = -1;
  if (colon == std::string::npos || colon == 0 ||
      !absl::SimpleAtoi(text.substr(colon + 1), &port) || port < 0 || port > 65535) {
    return absl::InvalidArgumentError(
        absl::StrCat(flag, " ", text, " is not HOST:PORT; give one such as 127.0.0.1:50051"));
  }
  return ListenAddress{text.substr(0, colon), static_cast<std::uint16_t>(port)};
}

}  // namespace graspdb
