// What all connections of the console share, and the addresses at which browsers open it.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/status.h"
#include "console/page_file.h"
#include "console/upstream.h"

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

// What one browser, or all of them together, may take.
struct HttpLimits {
  int max_connections = 64;               // more are closed at once
  std::size_t max_head_bytes = 16 << 10;  // request line and fields
  std::size_t max_body_bytes = std::size_t{64} << 20;
  std::size_t max_bodies_bytes = std::size_t{256} << 20;  // of all requests that are being read
  // For the head of a request, and for the next bytes of its body. Whole bodies and responses have
  // this time, and as much more as their bytes take at the lowest rate.
  std::chrono::milliseconds slow_time = std::chrono::seconds(20);
  std::size_t lowest_bytes_per_s = 1 << 20;
  std::chrono::milliseconds idle_time = std::chrono::seconds(60);  // between requests
};

// Thread-safe; outlives the connections.
struct Site {
  const Origins origins;
  const std::span<const PageFile> files;
  Upstream& upstream;
  const HttpLimits limits = {};
  std::atomic<int> connection_count = 0;
  std::atomic<std::size_t> body_byte_count = 0;
};

}  // namespace graspdb::console
