// Networks from which robots may connect.
#pragma once

#include <asio/ip/address.hpp>
#include <asio/ip/network_v4.hpp>
#include <asio/ip/network_v6.hpp>
#include <string>
#include <vector>

#include "absl/status/statusor.h"

namespace graspdb::client {

class AllowList {
 public:
  // Networks such as "10.3.0.0/24" and "fd00::/8", and single addresses; none: all addresses are
  // allowed. INVALID_ARGUMENT for another text.
  static absl::StatusOr<AllowList> Parse(const std::vector<std::string>& networks);

  // IPv4 addresses may be mapped to IPv6, as a socket for both has them.
  bool Allows(const asio::ip::address& address) const;

 private:
  std::vector<asio::ip::network_v4> v4_;
  std::vector<asio::ip::network_v6> v6_;
};

}  // namespace graspdb::client
