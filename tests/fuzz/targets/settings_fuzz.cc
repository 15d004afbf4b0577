// Settings of programs, one per line: "--flag" or "--flag=value" is an argument,
// "GRASPDB_NAME=value" a variable, "sensor: text" a camera, every other line goes to the file of
// --config. Both programs get all of them.
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include "absl/strings/str_split.h"
#include "client/cell/agent/settings/agent_options.h"
#include "client/cell/agent/settings/calibration_config.h"
#include "client/cell/sensors/sensor_spec.h"
#include "server/base/options.h"
#include "tests/fuzz/requirement.h"
#include "tests/fuzz/scratch_folder.h"

namespace graspdb::fuzz {
namespace {

constexpr char kVariablePrefix[] = "GRASPDB_";
constexpr char kSensorPrefix[] = "sensor: ";

// Settings of a program; the variables are set during its lifetime.
struct Start {
  explicit Start(std::string_view text) {
    static const ScratchFolder folder;
    std::string file;
    for (const absl::string_view view :
         absl::StrSplit(absl::string_view(text.data(), text.size()), '\n')) {
      const std::string line(view);
      if (line.find('\0') == std::string::npos && line.starts_with(kVariablePrefix)) {
        SetVariable(line);
      } else if (line.find('\0') == std::string::npos && line.starts_with("--")) {
        // Another file than ours might be a device.
        if (!line.starts_with("--config")) arguments.push_back(line);
      } else if (line.starts_with(kSensorPrefix)) {
        sensors.push_back(line.substr(sizeof(kSensorPrefix) - 1));
      } else {
        file += line + "\n";
      }
    }
    arguments.push_back("--config=" + folder.Write("settings.ini", file).string());
  }
  ~Start() {
    for (const std::string& name : variables) unsetenv(name.c_str());
  }
  Start(const Start&) = delete;
  Start& operator=(const Start&) = delete;

  void SetVariable(const std::string& line) {
    const std::size_t equals = line.find('=');
    const std::string name = line.substr(0, equals);
    if (equals == std::string::npos || name == "GRASPDB_CONFIG") return;
    setenv(name.c_str(), line.c_str() + equals + 1, 1);
    variables.push_back(name);
  }

  std::vector<std::string> arguments = {"program"};
  std::vector<std::string> variables;
  std::vector<std::string> sensors;
};

void StartServer(std::vector<char*>& arguments) {
  const auto parsed =
      server::ParseOptions(static_cast<int>(arguments.size() - 1), arguments.data());
  Require(parsed.exit_status == 0 || parsed.exit_status == 2, "a documented exit status");
  if (parsed.done) return;
  const server::ServerOptions& options = parsed.options;
  Require(options.workers >= 0 && options.queue.value_or(0) >= 0 && options.max_points >= 10,
          "within limits");
  Require(options.voxel_size_m > 0 && options.normal_radius_m > 0, "lengths above 0");
  Require(options.drain_s >= 0 && options.drain_s <= 3600, "a drain time within limits");
  server::CheckListenAddress(options).IgnoreError();
}

void StartAgent(std::vector<char*>& arguments) {
  const auto parsed =
      client::ParseAgentOptions(static_cast<int>(arguments.size() - 1), arguments.data());
  Require(parsed.exit_status == 0 || parsed.exit_status == 2, "a documented exit status");
  if (parsed.done) return;
  const client::AgentOptions& options = parsed.options;
  Require(options.time_limit_s >= 0.01 && options.time_limit_s <= 600,
          "a time limit within limits");
  Require(options.busy_retries >= 0 && options.busy_retries <= 1000, "retries within limits");
  Require(options.min_reach_m >= 0 && options.max_reach_m <= 1000, "a reach within limits");
  client::CheckAddresses(options).IgnoreError();
  client::LineOptions(options).IgnoreError();
  client::ParseCalibrations(options.calibrations, "cells/a").IgnoreError();
  const auto jobs = client::ParseJobs(options.jobs);
  if (!jobs.ok()) return;
  for (const auto& [id, job] : *jobs) {
    Require(id >= 0 && id <= 65535 && job.id == id, "a job number that a robot can request");
    Require(job.min_score >= 0 && job.min_score <= 1, "a score within limits");
  }
}

void ReadSensor(const std::string& text) {
  const auto spec = client::ParseSensorSpec(text);
  if (!spec.ok()) return;
  client::SensorOptions options(*spec);
  options.Flag("once");
  const double rate = options.Number("rate", 1, 0, 100);
  Require(rate >= 0 && rate <= 100, "a rate within limits");
  options.Integer("device", 0, 0, 9);
  options.Intrinsics(640, 480);
  options.Seed("seed", 1);
  options.List("parts");
  options.Finish(spec->kind).IgnoreError();
}

void Run(std::string_view text) {
  Start start(text);
  std::vector<char*> arguments;
  for (std::string& argument : start.arguments) arguments.push_back(argument.data());
  arguments.push_back(nullptr);
  StartServer(arguments);
  StartAgent(arguments);
  for (const std::string& sensor : start.sensors) ReadSensor(sensor);
}

}  // namespace
}  // namespace graspdb::fuzz

extern "C" int LLVMFuzzerInitialize(int*, char***) {
  // Wrong usage is printed.
  std::cout.rdbuf(nullptr);
  std::cerr.rdbuf(nullptr);
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  graspdb::fuzz::Run({reinterpret_cast<const char*>(data), size});
  return 0;
}
