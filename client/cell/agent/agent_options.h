// The settings of a cell's agent: flags, environment variables, a file.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/cell/agent/job_config.h"
#include "client/cell/robots/line_protocol.h"

namespace graspdb::client {

struct AgentOptions {
  std::string server = "127.0.0.1:50051";
  std::string cell;
  std::string sensor;
  std::vector<std::string> jobs = {"1 any"};
  std::vector<std::string> calibrations;
  std::string gri = "127.0.0.1:7100";
  std::string line = "127.0.0.1:7101";
  std::string line_format;  // a name that PoseFormatNamed knows; empty: robots must say FORMAT
  std::string health = "127.0.0.1:7102";
  bool allow_remote_robots = false;
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

// What reading the command line came to.
struct ParsedAgentOptions {
  AgentOptions options;
  bool done = false;    // nothing is left to do: help or version was printed
  int exit_status = 0;  // 2 when the usage is wrong
};

// Reads the command line, GRASPDB_... variables and the file of --config, in this order of
// precedence. Prints help, version and errors itself.
ParsedAgentOptions ParseAgentOptions(int argc, char** argv);

// How the line protocol writes poses where a robot does not say. INVALID_ARGUMENT when it is none.
absl::StatusOr<LineProtocolOptions> LineOptions(const AgentOptions& options);

// FAILED_PRECONDITION when robots on other machines could connect without that being allowed;
// INVALID_ARGUMENT when an address is none, or no robot could.
absl::Status CheckAddresses(const AgentOptions& options);

}  // namespace graspdb::client
