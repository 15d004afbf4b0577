#include "program/metrics/metrics_server.h"

#include <prometheus/collectable.h>
#include <prometheus/exposer.h>
#include <spdlog/spdlog.h>

#include <exception>
#include <mutex>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "program/connections/listen_address.h"
#include "program/connections/loopback.h"
#include "program/log/log_field.h"

namespace graspdb {
namespace {

// Of civetweb, which reads requests of at most 16 KiB. A slow client keeps a thread for so long.
constexpr char kThreads[] = "2";
constexpr char kRequestMs[] = "5000";

absl::Status CheckAllowed(const MetricsOptions& options, const ListenAddress& listen) {
  if (options.allow_remote || IsLoopback(listen.host)) return absl::OkStatus();
  return absl::FailedPreconditionError(absl::StrCat(
      "--metrics-listen ", options.listen,
      " can be reached from other machines, and metrics have names of objects and cells; listen on "
      "127.0.0.1, or add --allow-remote-metrics if the network is trusted"));
}

class Source : public prometheus::Collectable {
 public:
  explicit Source(MetricsServer::Collect collect) : collect_(std::move(collect)) {}

  MetricFamilies Collect() const override {
    const std::lock_guard lock(mutex_);
    try {  // the library does not catch what its threads throw
      return collect_();
    } catch (const std::exception& e) {
      spdlog::error("event=metrics_not_collected error={}", LogField(e.what()));
      return {};
    }
  }

 private:
  mutable std::mutex mutex_;
  const MetricsServer::Collect collect_;
};

}  // namespace

MetricsServer::MetricsServer(Collect collect)
    : source_(std::make_shared<Source>(std::move(collect))) {}

MetricsServer::~MetricsServer() = default;

void MetricsServer::Listen(const std::string& ports) {
  exposer_ = std::make_unique<prometheus::Exposer>(std::vector<std::string>{
      "listening_ports", ports, "num_threads", kThreads, "request_timeout_ms", kRequestMs});
  // Of civetweb's pattern the end, without which it is the beginning of a path.
  exposer_->RegisterCollectable(source_, "/metrics$");
}

absl::StatusOr<std::unique_ptr<MetricsServer>> MetricsServer::Start(const MetricsOptions& options,
                                                                    Collect collect) {
  if (options.listen.empty()) return nullptr;
  ASSIGN_OR_RETURN(const auto listen, ParseListenAddress("--metrics-listen", options.listen));
  RETURN_IF_ERROR(CheckAllowed(options, listen));
  const std::string host = listen.host == "localhost" ? "127.0.0.1" : listen.host;
  std::unique_ptr<MetricsServer> out(new MetricsServer(std::move(collect)));
  try {
    out->Listen(absl::StrCat(host, ":", listen.port));
    out->address_ = absl::StrCat(listen.host, ":", out->exposer_->GetListeningPorts().at(0));
  } catch (const std::exception& e) {
    spdlog::debug("event=metrics_not_served error={}", LogField(e.what()));
    return absl::UnavailableError(absl::StrCat("cannot listen on ", options.listen,
                                               " for metrics; is the port in use, or the address "
                                               "another machine's? Choose another "
                                               "--metrics-listen"));
  }
  return out;
}

}  // namespace graspdb
