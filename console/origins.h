// Which requests come from the console's own page.
//
// A page of another site can let the browser send requests to a console on the user's machine, also
// under a name that its own DNS server maps to 127.0.0.1. The browser states the name in Host, and
// the other page in Origin and Sec-Fetch-Site.
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"

namespace graspdb::console {

// Addresses at which browsers open the console.
class Origins {
 public:
  // For one that listens at `host` and `port`. `names`: further values of Host, "console.plant" or
  // "10.3.0.1:8443". `is_https`: whether browsers use TLS. A loopback address has its other names
  // too.
  Origins(std::string_view host, std::uint16_t port, const std::vector<std::string>& names,
          bool is_https);

  // PERMISSION_DENIED unless `host`, the value of Host, is one of them.
  absl::Status CheckHost(std::string_view host) const;

  // PERMISSION_DENIED unless a call is from the console's own page, or from no page: `origin` and
  // `fetch_site` are the values of Origin and Sec-Fetch-Site, empty where there is none.
  absl::Status CheckCall(std::string_view origin, std::string_view fetch_site) const;

 private:
  const std::string scheme_;
  std::set<std::string, std::less<>> hosts_;
};

}  // namespace graspdb::console
