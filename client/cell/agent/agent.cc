#include "client/cell/agent/agent.h"

#include <spdlog/spdlog.h>

#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/agent/calibrations.h"
#include "client/cell/agent/health.h"
#include "client/cell/agent/jobs/cell_metrics.h"
#include "client/cell/agent/jobs/cell_runner.h"
#include "client/cell/agent/jobs/counters.h"
#include "client/cell/agent/jobs/job_bundle.h"
#include "client/cell/blackbox/black_box.h"
#include "client/cell/robots/gri/gri_protocol.h"
#include "client/cell/robots/line/line_protocol.h"
#include "client/cell/robots/robot_server.h"
#include "client/sdk/resource_name.h"
#include "client/sdk/security.h"
#include "program/client_flags.h"
#include "program/connections/listen_address.h"

namespace graspdb::client {
namespace {

constexpr absl::Duration kHealthPeriod = absl::Milliseconds(200);

ConnectionOptions ConnectionTo(const AgentOptions& options) {
  ConnectionOptions out;
  out.server = options.server;
  out.timeout = absl::Seconds(options.time_limit_s);
  out.security = options.security;
  out.busy_retries = options.busy_retries;
  out.retry_frames = false;  // CaptureAndRecognize takes a new frame for each attempt
  return out;
}

CellRunnerOptions RunnerOptions(const AgentOptions& options) {
  CellRunnerOptions out;
  out.time_limit = absl::Seconds(options.time_limit_s);
  out.reach.min_m = options.min_reach_m;
  out.reach.max_m = options.max_reach_m;
  return out;
}

absl::StatusOr<std::unique_ptr<RobotServer>> Listen(RobotProtocol& protocol,
                                                    const std::string& flag,
                                                    const std::string& text,
                                                    const std::vector<std::string>& allow) {
  ASSIGN_OR_RETURN(const ListenAddress address, ParseListenAddress(flag, text));
  RobotServerOptions options;
  options.address = address.host == "localhost" ? "127.0.0.1" : address.host;
  options.port = address.port;
  options.allow = allow;
  absl::StatusOr<std::unique_ptr<RobotServer>> server = RobotServer::Start(protocol, options);
  if (!absl::IsUnavailable(server.status())) return server;
  return absl::UnavailableError(absl::StrCat(server.status().message(), " Choose another ", flag));
}

std::string AddressOf(const std::string& listen, const RobotServer* server) {
  if (server == nullptr) return "";
  return absl::StrCat(listen.substr(0, listen.rfind(':')), ":", server->port());
}

absl::StatusOr<std::unique_ptr<BlackBox>> OpenBlackBox(const AgentOptions& options) {
  if (options.black_box.empty()) return nullptr;
  BlackBoxOptions box;
  box.ring.folder = options.black_box;
  box.ring.byte_limit = static_cast<std::uint64_t>(options.black_box_mib) << 20U;
  return BlackBox::Open(box);
}

}  // namespace

// Members depend on those before them, and are destroyed in reverse order.
struct Agent::Parts {
  Parts(const AgentOptions& given, const Jobs& jobs,
        const std::vector<CalibrationConfig>& calibrated, const LineProtocolOptions& line,
        std::unique_ptr<DepthSensor> camera, std::unique_ptr<BlackBox> box)
      : options(given),
        black_box(std::move(box)),
        sensor(std::move(camera)),
        client(ConnectionTo(options)),
        metrics(options.metrics.listen.empty()
                    ? nullptr
                    : std::make_unique<CellMetrics>(ResourceName("cells", options.cell))),
        cell(client, ResourceName("cells", options.cell), absl::Seconds(options.cell_period_s)),
        capture_and_recognize(*sensor, client, cell, ResourceName("cells", options.cell)),
        gri_runner(jobs, JobProtocol::kGri, RunnerOptions(options), PartsOfRunner()),
        line_runner(jobs, JobProtocol::kLine, RunnerOptions(options), PartsOfRunner()),
        gri_jobs(gri_runner),
        calibrations(calibrated, client, *sensor, cell),
        gri_protocol(gri_jobs, &calibrations),
        line_protocol(line_runner, line) {}

  CellParts PartsOfRunner() {
    return {*sensor,
            client,
            cell,
            capture_and_recognize,
            counters,
            ResourceName("cells", options.cell),
            [this](const JobReport& report) { Keep(report); },
            metrics.get()};
  }

  void Keep(const JobReport& report) {
    if (black_box == nullptr) return;
    std::optional<v1::Bundle> bundle = BundleOf(report, cell.server_version());
    if (!bundle) return;
    const bool is_kept = options.black_box_all || report.poses.empty() ||
                         IsTroubled(*bundle, options.black_box_score);
    if (is_kept) (void)black_box->Keep(*std::move(bundle));  // drops are counted
  }

  std::string CountersText() const {
    const BlackBoxCounts kept = black_box == nullptr ? BlackBoxCounts() : black_box->counts();
    return absl::StrCat(counters.Text(), " bundles=", kept.kept, " bundles_dropped=", kept.dropped,
                        " bundles_failed=", kept.failed);
  }

  CellState State() {
    const auto connections = [](const auto& server) {
      return server == nullptr ? 0 : server->connection_count();
    };
    return {.is_camera_ready = sensor->IsReady(),
            .is_server_ready = cell.state().ok(),
            .gri_connections = connections(gri_server),
            .line_connections = connections(line_server),
            .bundles = black_box == nullptr ? BlackBoxCounts() : black_box->counts()};
  }

  const AgentOptions options;
  const std::unique_ptr<BlackBox> black_box;
  const std::unique_ptr<DepthSensor> sensor;
  Client client;
  const std::unique_ptr<CellMetrics> metrics;  // null: none
  Counters counters;
  CellCache cell;
  CaptureAndRecognize capture_and_recognize;
  CellRunner gri_runner;
  CellRunner line_runner;
  GriJobs gri_jobs;
  Calibrations calibrations;
  GriProtocol gri_protocol;
  LineProtocol line_protocol;
  std::unique_ptr<RobotServer> gri_server;
  std::unique_ptr<RobotServer> line_server;
  std::unique_ptr<Health> health;
  std::optional<CountersLog> counters_log;
  std::unique_ptr<MetricsServer> metrics_server;
};

Agent::Agent(std::unique_ptr<Parts> parts) : parts_(std::move(parts)) {}

Agent::~Agent() {
  parts_->capture_and_recognize.Stop();
  parts_->client.StopRetries();
}

absl::StatusOr<std::unique_ptr<Agent>> Agent::Start(const AgentOptions& options,
                                                    std::unique_ptr<DepthSensor> sensor) {
  RETURN_IF_ERROR(CheckAddresses(options));
  RETURN_IF_ERROR(CheckReach(options));
  RETURN_IF_ERROR(CheckSecurityFiles(options.security));
  RETURN_IF_ERROR(CheckOptions(ConnectionTo(options)));
  RETURN_IF_ERROR(CheckToken(ConnectionTo(options)));
  ASSIGN_OR_RETURN(Jobs jobs, ParseJobs(options.jobs));
  ASSIGN_OR_RETURN(const auto calibrations,
                   ParseCalibrations(options.calibrations, ResourceName("cells", options.cell)));
  ASSIGN_OR_RETURN(const LineProtocolOptions line, LineOptions(options));
  ASSIGN_OR_RETURN(std::unique_ptr<BlackBox> box, OpenBlackBox(options));
  auto parts =
      std::make_unique<Parts>(options, jobs, calibrations, line, std::move(sensor), std::move(box));
  if (!options.gri.empty()) {
    ASSIGN_OR_RETURN(parts->gri_server,
                     Listen(parts->gri_protocol, "--gri", options.gri, options.robots_allow));
  }
  if (!options.line.empty()) {
    ASSIGN_OR_RETURN(parts->line_server,
                     Listen(parts->line_protocol, "--line", options.line, options.robots_allow));
  }
  if (!options.health.empty()) {
    ASSIGN_OR_RETURN(
        parts->health,
        Health::Start(
            options.health, [p = parts.get()] { return p->gri_runner.IsReady(); }, kHealthPeriod));
  }
  ASSIGN_OR_RETURN(parts->metrics_server, MetricsServer::Start(options.metrics, [p = parts.get()] {
                     return p->metrics->Collect(p->State());
                   }));
  parts->counters_log.emplace([p = parts.get()] { return p->CountersText(); },
                              absl::Seconds(options.counters_period_s));
  return std::unique_ptr<Agent>(new Agent(std::move(parts)));
}

std::string Agent::gri_address() const {
  return AddressOf(parts_->options.gri, parts_->gri_server.get());
}

std::string Agent::line_address() const {
  return AddressOf(parts_->options.line, parts_->line_server.get());
}

std::string Agent::metrics_address() const {
  return parts_->metrics_server == nullptr ? "" : parts_->metrics_server->address();
}

std::string Agent::health_address() const {
  return parts_->health == nullptr ? "" : parts_->health->address();
}

}  // namespace graspdb::client
