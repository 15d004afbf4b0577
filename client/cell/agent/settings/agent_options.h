// The settings of a cell's agent, from flags, environment variables and a file.
#pragma once

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/agent/settings/job_config.h"
#include "client/cell/robots/line/line_protocol.h"
#include "client/sdk/client.h"
#include "program/metrics/metrics_server.h"

namespace graspdb::client {

struct AgentOptions {
  std::string server = "127.0.0.1:50051";
  SecurityOptions security = {};                        // of the connection to the server
  int busy_retries = ConnectionOptions().busy_retries;  // of calls other than Recognize
  std::string cell;
  std::string sensor;
  std::vector<std::string> jobs = {"1 any"};
  std::vector<std::string> calibrations;
  std::string gri = "127.0.0.1:7100";
  std::string line = "127.0.0.1:7101";
  std::string line_format;  // for PoseFormatNamed; empty: robots must send FORMAT
  std::string health = "127.0.0.1:7102";
  bool allow_remote_robots = false;
  MetricsOptions metrics = {};
  std::vector<std::string> robots_allow;  // networks; empty: all
  double time_limit_s = 5;
  double max_frame_age_s = 1;
  double min_reach_m = 0;
  double max_reach_m = 1000;
  double cell_period_s = 5;
  double counters_period_s = 60;
  std::string black_box;  // folder; empty: none
  int black_box_mib = 2048;
  bool black_box_all = false;
  double black_box_score = 0.8;
  std::string log_level = "info";
};

// The parsed command line.
struct ParsedAgentOptions {
  AgentOptions options;
  bool done = false;    // exit now: help, version or an error was printed
  int exit_status = 0;  // 2 when the usage is wrong
};

// Reads the command line, GRASPDB_... variables and the file of --config, in this order of
// precedence. Prints help, version and errors itself.
ParsedAgentOptions ParseAgentOptions(int argc, char** argv);

// The line protocol's default pose format. INVALID_ARGUMENT for an unknown one.
absl::StatusOr<LineProtocolOptions> LineOptions(const AgentOptions& options);

// INVALID_ARGUMENT when no distance is within reach.
absl::Status CheckReach(const AgentOptions& options);

// FAILED_PRECONDITION when other machines could connect without allow_remote_robots;
// INVALID_ARGUMENT for an invalid address, or when no robot protocol is enabled.
absl::Status CheckAddresses(const AgentOptions& options);

}  // namespace graspdb::client
