// graspdb-cell, the agent of a robot cell.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/agent/calibrations.h"
#include "client/cell/agent/health.h"
#include "client/cell/agent/jobs/cell_metrics.h"
#include "client/cell/agent/jobs/cell_runner.h"
#include "client/cell/agent/settings/agent_options.h"
#include "client/cell/blackbox/black_box.h"
#include "client/cell/robots/gri/gri_protocol.h"
#include "client/cell/robots/line/line_protocol.h"
#include "client/cell/robots/robot_server.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "client/sdk/resource_name.h"
#include "client/sdk/security.h"
#include "program/client_flags.h"
#include "program/connections/descriptor_limit.h"
#include "program/connections/listen_address.h"
#include "program/health_command.h"
#include "program/log/background_log.h"
#include "program/log/log_field.h"
#include "program/standard_streams.h"
#include "program/stop_signal.h"
#include "program/version.h"

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

absl::StatusOr<std::unique_ptr<RobotServer>> ListenFor(RobotProtocol& protocol,
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

// A running agent: camera, client and robot servers. Members depend on those before them, and are
// destroyed in reverse order: that closes the robots' connections and waits for running jobs.
class Agent {
 public:
  // Listens, with the given camera. Camera and server need not be available yet. Error messages
  // contain the next step.
  static absl::StatusOr<std::unique_ptr<Agent>> Start(const AgentOptions& options,
                                                      std::unique_ptr<DepthSensor> sensor);
  ~Agent() {
    capture_and_recognize_.Stop();
    client_.StopRetries();
  }
  Agent(const Agent&) = delete;
  Agent& operator=(const Agent&) = delete;

  // HOST:PORT with the actual port; empty when not listening.
  std::string gri_address() const { return AddressOf(options_.gri, gri_server_.get()); }
  std::string line_address() const { return AddressOf(options_.line, line_server_.get()); }
  std::string health_address() const { return health_ == nullptr ? "" : health_->address(); }
  std::string metrics_address() const {
    return metrics_server_ == nullptr ? "" : metrics_server_->address();
  }

 private:
  Agent(const AgentOptions& options, const Jobs& jobs,
        const std::vector<CalibrationConfig>& calibrations, const LineProtocolOptions& line,
        std::unique_ptr<DepthSensor> sensor, std::unique_ptr<BlackBox> black_box)
      : options_(options),
        black_box_(std::move(black_box)),
        sensor_(std::move(sensor)),
        client_(ConnectionTo(options)),
        metrics_(options.metrics.listen.empty()
                     ? nullptr
                     : std::make_unique<CellMetrics>(ResourceName("cells", options.cell))),
        cell_(client_, ResourceName("cells", options.cell), absl::Seconds(options.cell_period_s)),
        capture_and_recognize_(*sensor_, client_, cell_, ResourceName("cells", options.cell)),
        gri_runner_(jobs, JobProtocol::kGri, RunnerOptions(options), PartsOfRunner()),
        line_runner_(jobs, JobProtocol::kLine, RunnerOptions(options), PartsOfRunner()),
        gri_jobs_(gri_runner_),
        calibrations_(calibrations, client_, *sensor_, cell_),
        gri_protocol_(gri_jobs_, &calibrations_),
        line_protocol_(line_runner_, line) {}

  // Opens the ports.
  absl::Status Listen();

  CellParts PartsOfRunner() {
    return {*sensor_,
            client_,
            cell_,
            capture_and_recognize_,
            counters_,
            ResourceName("cells", options_.cell),
            [this](const JobReport& report) { Keep(report); },
            metrics_.get()};
  }

  void Keep(const JobReport& report) {
    if (black_box_ == nullptr) return;
    std::optional<v1::Bundle> bundle = BundleOf(report, cell_.server_version());
    if (!bundle) return;
    const bool is_kept = options_.black_box_all || report.poses.empty() ||
                         IsTroubled(*bundle, options_.black_box_score);
    if (is_kept) (void)black_box_->Keep(*std::move(bundle));  // drops are counted
  }

  BlackBoxCounts BundleCounts() const {
    return black_box_ == nullptr ? BlackBoxCounts() : black_box_->counts();
  }

  std::string CountersText() const {
    const BlackBoxCounts kept = BundleCounts();
    return absl::StrCat(counters_.Text(), " bundles=", kept.kept, " bundles_dropped=", kept.dropped,
                        " bundles_failed=", kept.failed);
  }

  CellState State() {
    const auto connections = [](const auto& server) {
      return server == nullptr ? 0 : server->connection_count();
    };
    return {.is_camera_ready = sensor_->IsReady(),
            .is_server_ready = cell_.state().ok(),
            .gri_connections = connections(gri_server_),
            .line_connections = connections(line_server_),
            .bundles = BundleCounts()};
  }

  const AgentOptions options_;
  const std::unique_ptr<BlackBox> black_box_;
  const std::unique_ptr<DepthSensor> sensor_;
  Client client_;
  const std::unique_ptr<CellMetrics> metrics_;  // null: none
  Counters counters_;
  CellCache cell_;
  CaptureAndRecognize capture_and_recognize_;
  CellRunner gri_runner_;
  CellRunner line_runner_;
  GriJobs gri_jobs_;
  Calibrations calibrations_;
  GriProtocol gri_protocol_;
  LineProtocol line_protocol_;
  std::unique_ptr<RobotServer> gri_server_;
  std::unique_ptr<RobotServer> line_server_;
  std::unique_ptr<Health> health_;
  std::optional<CountersLog> counters_log_;
  std::unique_ptr<MetricsServer> metrics_server_;
};

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
  std::unique_ptr<Agent> agent(
      new Agent(options, jobs, calibrations, line, std::move(sensor), std::move(box)));
  RETURN_IF_ERROR(agent->Listen());
  return agent;
}

absl::Status Agent::Listen() {
  if (!options_.gri.empty()) {
    ASSIGN_OR_RETURN(gri_server_,
                     ListenFor(gri_protocol_, "--gri", options_.gri, options_.robots_allow));
  }
  if (!options_.line.empty()) {
    ASSIGN_OR_RETURN(line_server_,
                     ListenFor(line_protocol_, "--line", options_.line, options_.robots_allow));
  }
  if (!options_.health.empty()) {
    ASSIGN_OR_RETURN(health_,
                     Health::Start(
                         options_.health, [this] { return gri_runner_.IsReady(); }, kHealthPeriod));
  }
  ASSIGN_OR_RETURN(metrics_server_, MetricsServer::Start(options_.metrics, [this] {
                     return metrics_->Collect(State());
                   }));
  counters_log_.emplace([this] { return CountersText(); },
                        absl::Seconds(options_.counters_period_s));
  return absl::OkStatus();
}

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "graspdb-cell: %s\n", std::string(status.message()).c_str());
  return absl::IsInvalidArgument(status) ? 2 : 1;
}

void PrintAddress(const char* service, const std::string& address) {
  if (!address.empty()) std::printf("%s on %s\n", service, address.c_str());
}

int Run(int argc, char** argv) {
  if (argc > 1 && std::string_view(argv[1]) == "health") {
    return WithOutputWritten(
        "graspdb-cell", RunHealthCommand("graspdb-cell", "127.0.0.1:7102", argc - 1, argv + 1));
  }
  const ParsedAgentOptions parsed = ParseAgentOptions(argc, argv);
  if (parsed.done) return WithOutputWritten("graspdb-cell", parsed.exit_status);
  const AgentOptions& options = parsed.options;
  if (const absl::Status limit = RaiseDescriptorLimit(); !limit.ok()) return Fail(limit);

  const StopSignal stop;
  StartBackgroundLog("graspdb-cell", options.log_level);
  SensorSettings settings;
  settings.max_age = absl::Seconds(options.max_frame_age_s);
  absl::StatusOr<std::unique_ptr<DepthSensor>> sensor = OpenSensor(options.sensor, settings);
  if (!sensor.ok()) return Fail(sensor.status());
  const std::string name = (*sensor)->Name();
  absl::StatusOr<std::unique_ptr<Agent>> agent = Agent::Start(options, *std::move(sensor));
  if (!agent.ok()) return Fail(agent.status());
  spdlog::info("event=start version={} cell={} sensor={} server={}", kVersion,
               LogField(options.cell), LogField(name), LogField(options.server));
  std::printf("camera: %s\n", name.c_str());
  PrintAddress("line protocol", (*agent)->line_address());
  PrintAddress("health", (*agent)->health_address());
  PrintAddress("metrics", (*agent)->metrics_address());
  PrintAddress("GRI", (*agent)->gri_address());
  std::printf("ready for robots\n");
  std::fflush(stdout);

  const int signal = stop.Wait();
  spdlog::info("event=stop signal={}", signal);
  return 0;
}

}  // namespace
}  // namespace graspdb::client

int main(int argc, char** argv) {
  graspdb::OpenStandardStreams();
  return graspdb::client::Run(argc, argv);
}
