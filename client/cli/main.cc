// graspdb, the command line.
#include <cstdio>
#include <exception>

#include "client/cli/bench_command.h"
#include "client/cli/catalog_commands.h"
#include "client/cli/cell_commands.h"
#include "client/cli/command.h"
#include "client/cli/describe_command.h"
#include "client/cli/export_command.h"
#include "client/cli/grasps_command.h"
#include "client/cli/import_command.h"
#include "client/cli/recognize_command.h"
#include "client/cli/replay_command.h"
#include "client/cli/robot_command.h"
#include "client/cli/sensor_commands.h"
#include "client/cli/teach_command.h"
#include "client/eval/eval_command.h"
#include "client/simulation/simulate_command.h"
#include "logging/log.h"
#include "settings/settings_file.h"

namespace graspdb::client {
namespace {

constexpr char kFooter[] =
    R"(A first round, without camera or robot:
  graspdb-server --db /tmp/catalogue &
  graspdb simulate --out /tmp/teach                 # sample parts on a turntable
  graspdb import /tmp/teach                         # teach them
  graspdb simulate --random 10 --seed 7 --out /tmp/ask
  graspdb recognize /tmp/ask                        # what is it, where, how good

Every flag is also a variable (--server is GRASPDB_SERVER) and a key of the file given to
--config. Exit status: 0 done, 1 understood but failed, 2 wrong usage, 3 no
server there.)";

enum ExitStatus { kDone = 0, kFailed = 1, kWrongUsage = 2, kNoServer = 3 };

void AddGlobalFlags(CLI::App& app, GlobalOptions* global) {
  app.add_option("--server", global->server, "HOST:PORT of the server")->capture_default_str();
  app.add_option("--timeout", global->timeout_s, "Seconds that a call may take")
      ->check(CLI::Range(0.001, 86400.0))
      ->capture_default_str();
  app.add_flag("--json", global->json, "Print answers as JSON, one document a line");
}

int Execute(const Action& action) {
  absl::Status status;
  try {
    status = action();
  } catch (const std::exception& e) {
    status = absl::InternalError(std::string("a library failed: ") + e.what());
  }
  if (status.ok()) return kDone;
  std::fprintf(stderr, "graspdb: %s\n", std::string(status.message()).c_str());
  return absl::IsUnavailable(status) ? kNoServer : kFailed;
}

int Run(int argc, char** argv) {
  CLI::App app("graspdb teaches objects to a graspdb server and asks it what a camera sees.",
               "graspdb");
  app.footer(kFooter);
  GlobalOptions global;
  Action action;
  AddGlobalFlags(app, &global);
  AddImportCommand(app, global, &action);
  AddTeachCommand(app, global, &action);
  AddRecognizeCommand(app, global, &action);
  AddReplayCommand(app, global, &action);
  AddBenchCommand(app, global, &action);
  AddDescribeCommand(app, global, &action);
  AddExportCommand(app, global, &action);
  AddObjectsCommand(app, global, &action);
  AddGraspsCommand(app, global, &action);
  AddCellsCommand(app, global, &action);
  AddStatusCommand(app, global, &action);
  AddRobotCommand(app, global, &action);
  AddSensorsCommand(app, global, &action);
  AddSimulateCommand(app, &action);
  AddEvalCommand(app, &action);
  AddSettingsFile(app);
  if (const std::optional<int> end = ParseArguments(app, argc, argv)) return *end;
  if (!action) {  // asked here, so that CLI11 names a command that it does not know
    std::fprintf(stderr, "A subcommand is required\nRun with --help for more information.\n");
    return kWrongUsage;
  }
  StartLog("graspdb", "warn");  // standard output is the answers'
  return Execute(action);
}

}  // namespace
}  // namespace graspdb::client

int main(int argc, char** argv) { return graspdb::client::Run(argc, argv); }
