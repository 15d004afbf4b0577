// Proxies that the environment names for gRPC.
#pragma once

#include <string>
#include <string_view>

namespace graspdb {

// Whether a gRPC target is at a loopback address, so that no proxy may stand between: an address or
// name of the loopback interface, or a socket file.
bool IsLocalTarget(std::string_view target);

// "; http_proxy is set …", for the end of the error of a failed connection to `target`. Empty where
// gRPC uses no proxy for it. Without the password that a proxy's address may have.
std::string ProxyAdvice(std::string_view target);

}  // namespace graspdb
