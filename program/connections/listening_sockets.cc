#include "program/connections/listening_sockets.h"

#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <string>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb {
namespace {

// A port that is free at the first address may be in use at the next one.
constexpr int kPortAttempts = 16;
// gRPC's own default for servers, ms.
constexpr int kUserTimeoutMs = 20'000;

using Addresses = std::unique_ptr<addrinfo, decltype(&freeaddrinfo)>;

absl::Status SystemError(int error) {
  return absl::UnavailableError(std::generic_category().message(error));
}

// Without the brackets of an IPv6 address; empty for all addresses.
std::string NameForLookup(std::string host) {
  if (host.starts_with('[') && host.ends_with(']')) host = host.substr(1, host.size() - 2);
  return host == "0.0.0.0" || host == "::" ? "" : host;
}

absl::StatusOr<Addresses> LookUp(const std::string& host) {
  const std::string name = NameForLookup(host);
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_PASSIVE | AI_NUMERICSERV;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(name.empty() ? nullptr : name.c_str(), "0", &hints, &found);
  if (error != 0) return absl::UnavailableError(absl::StrCat(host, ": ", gai_strerror(error)));
  return Addresses(found, freeaddrinfo);
}

void SetPort(sockaddr_storage* address, std::uint16_t port) {
  if (address->ss_family == AF_INET6) {
    reinterpret_cast<sockaddr_in6*>(address)->sin6_port = htons(port);
  } else {
    reinterpret_cast<sockaddr_in*>(address)->sin_port = htons(port);
  }
}

std::uint16_t PortOf(int socket) {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0) return 0;
  return ntohs(address.ss_family == AF_INET6
                   ? reinterpret_cast<const sockaddr_in6&>(address).sin6_port
                   : reinterpret_cast<const sockaddr_in&>(address).sin_port);
}

// Listens at one address; 0 or an errno. Without SO_REUSEPORT: two servers on one port would each
// get some of the calls; the second must fail.
int ListenAtOne(const addrinfo& at, std::uint16_t port, FileDescriptor* out) {
  FileDescriptor made(socket(at.ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (!made.is_open()) return errno;
  const int on = 1;
  // A server that starts again need not wait for the old connections to expire.
  setsockopt(made.number(), SOL_SOCKET, SO_REUSEADDR, &on, sizeof(on));
  // Inherited by the connections, as from gRPC's own listener: one whose peer reads nothing, or is
  // gone without a word, ends when nothing that was sent to it has arrived for this long.
  setsockopt(made.number(), IPPROTO_TCP, TCP_USER_TIMEOUT, &kUserTimeoutMs, sizeof(kUserTimeoutMs));
  // IPv4 has a socket of its own.
  if (at.ai_family == AF_INET6) {
    setsockopt(made.number(), IPPROTO_IPV6, IPV6_V6ONLY, &on, sizeof(on));
  }
  sockaddr_storage address{};
  std::copy_n(reinterpret_cast<const char*>(at.ai_addr), at.ai_addrlen,
              reinterpret_cast<char*>(&address));
  SetPort(&address, port);
  if (bind(made.number(), reinterpret_cast<sockaddr*>(&address), at.ai_addrlen) != 0) return errno;
  if (listen(made.number(), SOMAXCONN) != 0) return errno;
  *out = std::move(made);
  return 0;
}

// Whether an address before `address` is the same: the machine's names may list one twice.
bool IsRepeated(const addrinfo& addresses, const addrinfo& address) {
  for (const addrinfo* at = &addresses; at != &address; at = at->ai_next) {
    if (at->ai_addrlen == address.ai_addrlen &&
        std::memcmp(at->ai_addr, address.ai_addr, address.ai_addrlen) == 0) {
      return true;
    }
  }
  return false;
}

// At all addresses, at the port or, for 0, at one that is free at the first address. What fails for
// another reason than a port in use is left out: the kernel may lack a family, the machine an
// address.
absl::StatusOr<ListeningSockets> ListenAtAll(const addrinfo& addresses, std::uint16_t port) {
  ListeningSockets out;
  out.port = port;
  int last_error = EADDRNOTAVAIL;
  for (const addrinfo* at = &addresses; at != nullptr; at = at->ai_next) {
    if (IsRepeated(addresses, *at)) continue;
    FileDescriptor socket;
    const int error = ListenAtOne(*at, out.port, &socket);
    if (error == EADDRINUSE) return SystemError(error);
    if (error != 0) {
      last_error = error;
      continue;
    }
    if (out.port == 0) out.port = PortOf(socket.number());
    out.sockets.push_back(std::move(socket));
  }
  if (out.sockets.empty()) return SystemError(last_error);
  return out;
}

}  // namespace

absl::StatusOr<ListeningSockets> ListenAt(const ListenAddress& address) {
  ASSIGN_OR_RETURN(const Addresses addresses, LookUp(address.host));
  absl::StatusOr<ListeningSockets> out = ListenAtAll(*addresses, address.port);
  for (int i = 1; !out.ok() && address.port == 0 && i < kPortAttempts; ++i) {
    out = ListenAtAll(*addresses, 0);
  }
  return out;
}

}  // namespace graspdb
