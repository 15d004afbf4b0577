// graspdb, the command line.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "client/cli/backup/backup_commands.h"
#include "client/cli/base/command.h"
#include "client/cli/cells/commands.h"
#include "client/cli/objects/commands.h"
#include "client/cli/recognize/commands.h"
#include "client/cli/teach/commands.h"
#include "program/standard_streams.h"

namespace graspdb::client {
namespace {

constexpr char kLab[] = "graspdb-lab";
constexpr char kConsole[] = "graspdb-console";

struct OtherCommand {
  std::string_view name;
  std::string_view description;
  const char* program;
};

// The commands that other programs implement.
constexpr std::array<OtherCommand, 5> kCommands = {{
    {"bench", "Measure a server's latency and throughput", kLab},
    {"robot", "Run a simulated robot that picks objects seen by a simulated camera", kLab},
    {"simulate", "Take captures with a simulated depth camera", kLab},
    {"eval", "Measure recognition rates and pose errors on simulated and real frames", kLab},
    {"console", "Show scenes, answers and the catalogue of a server in a browser", kConsole},
}};

// The first argument that is neither a flag nor a flag's value; empty without one.
std::string_view CommandOf(const CLI::App& app, int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (!argument.starts_with('-')) return argv[i];
    const CLI::Option* flag = app.get_option_no_throw(argument);
    const bool takes_value =
        flag != nullptr && flag->get_expected_max() > 0 && flag->get_type_size() > 0;
    if (takes_value || argument == "--config") ++i;  // which AddSettingsFile() adds later
  }
  return {};
}

std::vector<std::string> OtherCommands() {
  std::vector<std::string> out;
  out.reserve(kCommands.size());
  for (const OtherCommand& command : kCommands) out.emplace_back(command.name);
  return out;
}

// Lists them in the help of `app`.
void AddOtherCommands(CLI::App& app) {
  for (const OtherCommand& command : kCommands) {
    app.add_subcommand(std::string(command.name), std::string(command.description));
  }
}

// If the command line names one of them, replaces this process with its program, which is beside
// this one, or prints an error and exits with 1. Else does nothing.
void RunOtherCommand(const CLI::App& app, int argc, char** argv) {
  const std::string_view name = CommandOf(app, argc, argv);
  const auto* command = std::ranges::find(kCommands, name, &OtherCommand::name);
  if (command == kCommands.end()) return;
  const absl::Status failed = BecomeProgram(command->program, {argv + 1, argv + argc});
  std::fprintf(stderr, "graspdb: '%s' %s\n", std::string(name).c_str(),
               std::string(failed.message()).c_str());
  std::exit(1);
}

constexpr char kFooter[] =
    R"(A first run, without camera or robot:
  graspdb-server --db /tmp/catalogue &
  graspdb simulate --out /tmp/teach                 # sample parts on a turntable
  graspdb import /tmp/teach                         # teach them
  graspdb simulate --random 10 --seed 7 --out /tmp/query
  graspdb recognize /tmp/query                      # objects, poses and scores

Every flag is also an environment variable (--server is GRASPDB_SERVER) and a key of the file
given to --config. Exit status: 0 done, 1 failed, 2 wrong usage, 3 no server reachable.)";

int Run(int argc, char** argv) {
  CLI::App app(
      "graspdb teaches objects to a graspdb server and recognises them in depth-camera frames.",
      "graspdb");
  app.footer(kFooter);
  GlobalOptions global;
  Action action;
  AddGlobalFlags(app, &global);
  AddImportCommand(app, global, &action);
  AddTeachCommand(app, global, &action);
  AddRecognizeCommand(app, global, &action);
  AddReplayCommand(app, global, &action);
  AddDescribeCommand(app, global, &action);
  AddExportCommand(app, global, &action);
  AddBackupCommands(app, global, &action);
  AddUploadsCommand(app, global, &action);
  AddObjectsCommand(app, global, &action);
  AddGraspsCommand(app, global, &action);
  AddCellsCommand(app, global, &action);
  AddStatusCommand(app, global, &action);
  AddWatchCommand(app, global, &action);
  AddDoctorCommand(app, global, &action);
  AddSensorsCommand(app, global, &action);
  AddOtherCommands(app);
  RunOtherCommand(app, argc, argv);
  return RunCommandLine(app, global, action, OtherCommands(), argc, argv);
}

}  // namespace
}  // namespace graspdb::client

int main(int argc, char** argv) {
  graspdb::OpenStandardStreams();
  return graspdb::WithOutputWritten("graspdb", graspdb::client::Run(argc, argv));
}
