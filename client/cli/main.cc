// graspdb, the command line.
#include "client/cli/backup/backup_commands.h"
#include "client/cli/base/command_line.h"
#include "client/cli/cells/commands.h"
#include "client/cli/objects/commands.h"
#include "client/cli/other_programs.h"
#include "client/cli/recognize/commands.h"
#include "client/cli/teach/commands.h"
#include "program/standard_streams.h"

namespace graspdb::client {
namespace {

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
