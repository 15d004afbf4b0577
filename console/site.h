// What all connections of the console share.
#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <span>

#include "console/origins.h"
#include "console/page_file.h"
#include "console/upstream.h"

namespace graspdb::console {

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
