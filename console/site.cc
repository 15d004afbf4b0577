#include "console/site.h"

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "program/connections/loopback.h"

namespace graspdb::console {
namespace {

constexpr std::uint16_t kHttpPort = 80;
constexpr std::uint16_t kHttpsPort = 443;

std::string LowerCase(std::string_view text) {
  return absl::AsciiStrToLower(absl::string_view(text.data(), text.size()));
}

}  // namespace

Origins::Origins(std::string_view host, std::uint16_t port, const std::vector<std::string>& names,
                 bool is_https)
    : scheme_(is_https ? "https://" : "http://") {
  std::vector<std::string> own = {LowerCase(host)};
  if (IsLoopback(host)) own = {LowerCase(host), "localhost", "127.0.0.1", "[::1]"};
  for (const std::string& name : own) {
    hosts_.insert(absl::StrCat(name, ":", port));
    // Browsers leave it out.
    if (port == (is_https ? kHttpsPort : kHttpPort)) hosts_.insert(name);
  }
  for (const std::string& name : names) hosts_.insert(LowerCase(name));
}

absl::Status Origins::CheckHost(std::string_view host) const {
  if (hosts_.contains(LowerCase(host))) return absl::OkStatus();
  return absl::PermissionDeniedError(
      absl::StrCat("the console is not opened by this name; open it as ",
                   absl::StrJoin(hosts_, " or "), ", or start it with --host NAME"));
}

absl::Status Origins::CheckCall(std::string_view origin, std::string_view fetch_site) const {
  const bool is_own_origin =
      origin.empty() ||
      (origin.starts_with(scheme_) && hosts_.contains(LowerCase(origin.substr(scheme_.size()))));
  // "none": the user typed the address.
  const bool is_own_site =
      fetch_site.empty() || fetch_site == "same-origin" || fetch_site == "none";
  if (is_own_origin && is_own_site) return absl::OkStatus();
  return absl::PermissionDeniedError("calls from pages of other sites are refused");
}

}  // namespace graspdb::console
