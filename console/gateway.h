// The console's HTTP server.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "console/page_file.h"
#include "console/site.h"
#include "console/upstream.h"

namespace graspdb::console {

struct GatewayOptions {
  std::string listen = "127.0.0.1:8080";
  std::string tls_cert = {};  // PEM files; empty: no TLS
  std::string tls_key = {};
  bool behind_proxy = false;            // which encrypts the connections of browsers
  std::vector<std::string> hosts = {};  // further names by which browsers open the console
  HttpLimits limits = {};
};

// INVALID_ARGUMENT for options that contradict each other, FAILED_PRECONDITION where other machines
// could connect without encryption, or for files that cannot be used.
absl::Status CheckOptions(const GatewayOptions& options);

// Serves the page and forwards its calls, on threads of its own. Thread-safe.
class Gateway {
 public:
  // UNAVAILABLE where it cannot listen, and the errors of CheckOptions. The files outlive it.
  static absl::StatusOr<std::unique_ptr<Gateway>> Start(const GatewayOptions& options,
                                                        std::span<const PageFile> files,
                                                        std::unique_ptr<Upstream> upstream);
  // Closes all connections, and ends their calls.
  ~Gateway();
  Gateway(const Gateway&) = delete;
  Gateway& operator=(const Gateway&) = delete;

  // "http://127.0.0.1:8080/"
  const std::string& url() const;
  std::uint16_t port() const;
  // Open connections, for tests.
  int connection_count() const;

 private:
  struct Parts;
  explicit Gateway(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace graspdb::console
