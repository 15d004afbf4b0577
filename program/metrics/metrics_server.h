// Metrics over HTTP, for Prometheus.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "absl/status/statusor.h"
#include "program/metrics/families.h"

namespace prometheus {
class Collectable;
class Exposer;
}  // namespace prometheus

namespace graspdb {

// The settings of a program.
struct MetricsOptions {
  std::string listen;  // HOST:PORT; empty: none
  bool allow_remote = false;
};

// Answers GET /metrics in Prometheus' text format. Has neither encryption nor identities, and two
// threads: a client that sends nothing occupies one for five seconds, and delays other scrapes but
// nothing else.
class MetricsServer {
 public:
  // Called for each scrape, on threads of this, one at a time.
  using Collect = std::function<MetricFamilies()>;

  // Null without an address. INVALID_ARGUMENT if it is invalid, FAILED_PRECONDITION if other
  // machines can reach it and this is not allowed, UNAVAILABLE if it cannot listen there.
  static absl::StatusOr<std::unique_ptr<MetricsServer>> Start(const MetricsOptions& options,
                                                              Collect collect);
  // Waits for a running `collect`.
  ~MetricsServer();
  MetricsServer(const MetricsServer&) = delete;
  MetricsServer& operator=(const MetricsServer&) = delete;

  // HOST:PORT with the actual port.
  const std::string& address() const { return address_; }

 private:
  explicit MetricsServer(Collect collect);
  // Listens at `ports`, as civetweb writes them; exceptions of the library.
  void Listen(const std::string& ports);

  std::shared_ptr<prometheus::Collectable> source_;
  std::unique_ptr<prometheus::Exposer> exposer_;  // uses `source_`
  std::string address_;
};

}  // namespace graspdb
