// graspdb-cell, the agent of a robot cell.
#include <spdlog/spdlog.h>

#include <cstdio>
#include <string>
#include <string_view>

#include "client/cell/agent/agent.h"
#include "client/cell/agent/settings/agent_options.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "program/connections/descriptor_limit.h"
#include "program/health_command.h"
#include "program/log/background_log.h"
#include "program/log/log_field.h"
#include "program/standard_streams.h"
#include "program/stop_signal.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

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
