#include "client/cell/robots/allow_list.h"

#include <algorithm>

#include "absl/strings/str_cat.h"

namespace graspdb::client {

absl::StatusOr<AllowList> AllowList::Parse(const std::vector<std::string>& networks) {
  AllowList out;
  for (const std::string& text : networks) {
    const bool is_v6 = text.find(':') != std::string::npos;
    const bool is_one = text.find('/') == std::string::npos;
    const std::string network = is_one ? text + (is_v6 ? "/128" : "/32") : text;
    asio::error_code error;
    if (is_v6) {
      out.v6_.push_back(asio::ip::make_network_v6(network, error).canonical());
    } else {
      out.v4_.push_back(asio::ip::make_network_v4(network, error).canonical());
    }
    if (error) {
      return absl::InvalidArgumentError(
          absl::StrCat("--robots-allow: ", text,
                       " is no network; give addresses or networks such as 10.3.0.0/24"));
    }
  }
  return out;
}

bool AllowList::Allows(const asio::ip::address& address) const {
  if (v4_.empty() && v6_.empty()) return true;
  if (address.is_v6() && !address.to_v6().is_v4_mapped()) {
    return std::ranges::any_of(v6_, [&](const asio::ip::network_v6& network) {
      return asio::ip::network_v6(address.to_v6(), network.prefix_length()).canonical() == network;
    });
  }
  const asio::ip::address_v4 v4 =
      address.is_v4() ? address.to_v4()
                      : asio::ip::make_address_v4(asio::ip::v4_mapped, address.to_v6());
  return std::ranges::any_of(v4_, [&](const asio::ip::network_v4& network) {
    return asio::ip::network_v4(v4, network.prefix_length()).canonical() == network;
  });
}

}  // namespace graspdb::client
