// Addresses of the clients of connections.
#pragma once

#include <string>

namespace graspdb {

// The client of an accepted connection as grpc::ServerContext::peer() names it:
// "ipv4:10.3.0.7:41522", "ipv6:%5B2001:db8::7%5D:41522"; empty if `connection` is none.
std::string PeerOf(int connection);

// "ipv4:10.3.0.7" of "ipv4:10.3.0.7:41522". Of an IPv6 address its network, "ipv6:2001:db8:1:2::":
// one machine may have any address of it.
std::string NetworkOfPeer(const std::string& peer);

}  // namespace graspdb
