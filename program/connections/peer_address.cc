#include "program/connections/peer_address.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"

namespace graspdb {
namespace {

std::string TextOf(int family, const void* address) {
  std::array<char, INET6_ADDRSTRLEN> out{};
  inet_ntop(family, address, out.data(), static_cast<socklen_t>(out.size()));
  return out.data();
}

}  // namespace

std::string PeerOf(int connection) {
  sockaddr_storage peer{};
  socklen_t size = sizeof(peer);
  if (getpeername(connection, reinterpret_cast<sockaddr*>(&peer), &size) != 0) return {};
  if (peer.ss_family == AF_INET) {
    const auto& ipv4 = reinterpret_cast<const sockaddr_in&>(peer);
    return absl::StrCat("ipv4:", TextOf(AF_INET, &ipv4.sin_addr), ":", ntohs(ipv4.sin_port));
  }
  if (peer.ss_family != AF_INET6) return {};
  const auto& ipv6 = reinterpret_cast<const sockaddr_in6&>(peer);
  if (IN6_IS_ADDR_V4MAPPED(&ipv6.sin6_addr)) {
    constexpr std::size_t kIpv4Offset = 12;
    return absl::StrCat("ipv4:", TextOf(AF_INET, ipv6.sin6_addr.s6_addr + kIpv4Offset), ":",
                        ntohs(ipv6.sin6_port));
  }
  return absl::StrCat("ipv6:%5B", TextOf(AF_INET6, &ipv6.sin6_addr), "%5D:", ntohs(ipv6.sin6_port));
}

std::string NetworkOfPeer(const std::string& peer) {
  std::string address = peer.substr(0, peer.rfind(':'));
  if (!absl::StartsWith(address, "ipv6:")) return address;
  std::string host = absl::StrReplaceAll(address.substr(5), {{"%5B", ""}, {"%5D", ""}});
  std::erase_if(host, [](char c) { return c == '[' || c == ']'; });
  in6_addr network{};
  if (inet_pton(AF_INET6, host.c_str(), &network) != 1) return address;
  constexpr std::size_t kNetworkBytes = 8;
  std::fill(std::begin(network.s6_addr) + kNetworkBytes, std::end(network.s6_addr), 0);
  return absl::StrCat("ipv6:", TextOf(AF_INET6, &network));
}

}  // namespace graspdb
