#include "program/connections/proxy.h"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "program/connections/loopback.h"

namespace graspdb {
namespace {

// "[::1]" of "ipv6:[::1]:50051", "example.org" of "dns:///example.org:50051".
std::string_view HostOf(std::string_view target) {
  if (const std::size_t slash = target.rfind('/'); slash != std::string_view::npos) {
    target.remove_prefix(slash + 1);
  }
  for (const std::string_view scheme : {"dns:", "ipv4:", "ipv6:"}) {
    if (target.starts_with(scheme)) target.remove_prefix(scheme.size());
  }
  const std::size_t colon = target.rfind(':');
  // The last colon of "[::1]" is no port's.
  if (colon == std::string_view::npos || target.ends_with(']')) return target;
  return target.substr(0, colon);
}

// The first of the variables that is set; as for gRPC, an empty one is set too.
const char* FirstSet(std::initializer_list<const char*> variables) {
  for (const char* variable : variables) {
    if (std::getenv(variable) != nullptr) return variable;
  }
  return nullptr;
}

// gRPC compares the ends of names.
bool IsExcepted(std::string_view host) {
  const char* variable = FirstSet({"no_grpc_proxy", "no_proxy"});
  if (variable == nullptr) return false;
  const std::vector<std::string> ends =
      absl::StrSplit(std::getenv(variable), ',', absl::SkipWhitespace());
  return std::ranges::any_of(ends, [&](const std::string& end) {
    return absl::EndsWithIgnoreCase(absl::string_view(host.data(), host.size()),
                                    absl::StripAsciiWhitespace(end));
  });
}

}  // namespace

bool IsLocalTarget(std::string_view target) {
  return target.starts_with("unix:") || target.starts_with("unix-abstract:") ||
         IsLoopback(HostOf(target));
}

std::string ProxyAdvice(std::string_view target) {
  const std::string_view host = HostOf(target);
  if (IsLocalTarget(target) || IsExcepted(host)) return "";
  const char* variable = FirstSet({"grpc_proxy", "https_proxy", "http_proxy"});  // gRPC's order
  if (variable == nullptr) return "";
  const std::string value = std::getenv(variable);
  if (value.empty()) return "";
  return absl::StrCat("; ", variable, " is set, so gRPC connects through the proxy ",
                      value.substr(value.rfind('@') + 1),
                      ": if it does not lead to the server add ", std::string(host),
                      " to no_proxy");
}

}  // namespace graspdb
