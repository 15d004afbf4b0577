#include "client/cell/agent/settings/agent_options.h"

#include <CLI/CLI.hpp>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/cell/agent/settings/calibration_config.h"
#include "program/client_flags.h"
#include "program/connections/listen_address.h"
#include "program/connections/loopback.h"
#include "program/metrics/metrics_flags.h"
#include "program/settings_file.h"
#include "program/version.h"

namespace graspdb::client {
namespace {

constexpr char kFooter[] =
    R"(Every flag is also an environment variable (--time-limit is GRASPDB_TIME_LIMIT) and a key of
the --config file:
  server="10.0.0.5:50051"
  cell="press-3"
  sensor="freenect"
  gri="0.0.0.0:7100"
  allow-remote-robots=true
  job=["1 any","2 object=flange"]

A first try without camera and robot:
  graspdb-cell --cell press-3 --sensor simulated
Stop it with SIGTERM or Ctrl-C: running jobs are finished. graspdb-cell health checks a running one.
Exit status: 0 stopped by a signal, 1 could not start, 2 wrong usage.)";

void AddAddresses(CLI::App& app, AgentOptions* o) {
  app.add_option("--server", o->server, "HOST:PORT of graspdb-server")->capture_default_str();
  AddSecurityFlags(app, &o->security);
  AddBusyRetriesFlag(app, &o->busy_retries,
                     "How often a call is sent again while the server is busy; frames are taken "
                     "anew until --time-limit instead");
  app.add_option("--gri", o->gri,
                 "HOST:PORT for robots with the Generic Robot Interface; \"\" for none")
      ->capture_default_str();
  app.add_option("--line", o->line, "HOST:PORT for the line protocol; \"\" for none")
      ->capture_default_str();
  app.add_option("--line-format", o->line_format,
                 "Pose format of the line protocol for robots that send no FORMAT: a vendor's name "
                 "or a number from 1 to 51");
  app.add_option("--health", o->health, "HOST:PORT of the health service (gRPC); \"\" for none")
      ->capture_default_str();
  AddMetricsFlags(app, &o->metrics);
  app.add_flag("--allow-remote-robots", o->allow_remote_robots,
               "Allow addresses that other machines can reach; the robot protocols have neither "
               "encryption nor passwords, so expose them only to the cell's network");
  app.add_option("--robots-allow", o->robots_allow,
                 "Networks or addresses from which robots may connect, e.g. 10.3.0.0/24,10.4.0.7; "
                 "others are disconnected at once")
      ->delimiter(',')
      ->type_name("CIDR,...");
}

void AddLimits(CLI::App& app, AgentOptions* o) {
  const auto number = [&](const char* flag, double* value, const char* text, double lo, double hi) {
    app.add_option(flag, *value, text)->check(CLI::Range(lo, hi))->capture_default_str();
  };
  number("--time-limit", &o->time_limit_s, "Maximum duration of a job, waiting included, s", 0.01,
         600);
  number("--max-frame-age", &o->max_frame_age_s, "Maximum age of a frame, s", 0.01, 60);
  number("--min-reach", &o->min_reach_m, "Minimum distance of the tool from the robot's base, m", 0,
         1000);
  number("--max-reach", &o->max_reach_m, "Maximum distance of the tool from the robot's base, m", 0,
         1000);
  number("--cell-period", &o->cell_period_s, "Seconds between reads of the cell's calibration",
         0.05, 3600);
  number("--counters-period", &o->counters_period_s, "Seconds between counters in the log", 0.1,
         86400);
}

void AddBlackBox(CLI::App& app, AgentOptions* o) {
  app.add_option("--black-box", o->black_box,
                 "Folder for failed and low-score requests, for graspdb replay");
  app.add_option("--black-box-mib", o->black_box_mib,
                 "Maximum size of the folder, MiB; the oldest are deleted")
      ->check(CLI::Range(1, 1 << 24))
      ->capture_default_str();
  app.add_flag("--black-box-all", o->black_box_all, "Keep all requests");
  app.add_option("--black-box-score", o->black_box_score,
                 "Keep responses whose best score is lower")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
}

}  // namespace

ParsedAgentOptions ParseAgentOptions(int argc, char** argv) {
  ParsedAgentOptions out;
  AgentOptions* o = &out.options;
  CLI::App app(
      "graspdb-cell is the agent of a robot cell: it captures frames, sends them to the "
      "server, and returns grasp poses to the robot.",
      "graspdb-cell");
  app.set_version_flag("--version", absl::StrCat("graspdb-cell ", kVersion));
  app.footer(absl::StrCat(JobHelp(), "\n\n", CalibrationHelp(), "\n\n", kFooter));
  app.add_option("--cell", o->cell, "Id of the cell, created by graspdb cells set")->required();
  app.add_option("--sensor", o->sensor, "The camera: freenect, openni2, files:FOLDER, simulated")
      ->required();
  app.add_option("--job", o->jobs, "A job, see below; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("\"NUMBER WORDS\"")
      ->capture_default_str();
  app.add_option("--calibrate", o->calibrations,
                 "A hand-eye calibration that robots may run, see below; may be repeated")
      ->expected(1)
      ->take_all()
      ->type_name("\"PIPELINE WORDS\"");
  AddAddresses(app, o);
  AddLimits(app, o);
  AddBlackBox(app, o);
  app.add_option("--log-level", o->log_level, "Minimum level of log messages on stderr")
      ->check(CLI::IsMember({"debug", "info", "warn", "error", "off"}))
      ->capture_default_str();
  AddSettingsFile(app);
  const std::optional<int> end = ParseArguments(app, argc, argv);
  out.done = end.has_value();
  out.exit_status = end.value_or(0);
  return out;
}

absl::StatusOr<LineProtocolOptions> LineOptions(const AgentOptions& options) {
  if (options.line_format.empty()) return LineProtocolOptions();
  const absl::StatusOr<int> code = PoseFormatNamed(options.line_format);
  if (!code.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--line-format: ", code.status().message()));
  }
  return LineProtocolOptions{.pose_format = *code};
}

absl::Status CheckReach(const AgentOptions& options) {
  if (options.min_reach_m < options.max_reach_m) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("--min-reach ", options.min_reach_m, " is not below --max-reach ",
                   options.max_reach_m, ", so no pose is within reach; both are in metres"));
}

absl::Status CheckAddresses(const AgentOptions& options) {
  if (options.gri.empty() && options.line.empty()) {
    return absl::InvalidArgumentError("neither robot protocol is enabled; give --gri or --line");
  }
  const std::vector<std::pair<std::string, std::string>> flags = {
      {"--gri", options.gri}, {"--line", options.line}, {"--health", options.health}};
  for (const auto& [flag, text] : flags) {
    if (text.empty()) continue;
    ASSIGN_OR_RETURN(const ListenAddress address, ParseListenAddress(flag, text));
    if (options.allow_remote_robots || IsLoopback(address.host)) continue;
    return absl::FailedPreconditionError(absl::StrCat(
        flag, " ", text, " can be reached from other machines, without encryption or password; ",
        "add --allow-remote-robots if only the cell's network reaches it"));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
