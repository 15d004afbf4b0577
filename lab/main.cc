// graspdb-lab: the commands of `graspdb` for experiments, simulations and load tests.
#include "client/cli/base/command.h"
#include "lab/commands/commands.h"
#include "program/standard_streams.h"

namespace graspdb::lab {
namespace {

int Run(int argc, char** argv) {
  // The name on the command line.
  CLI::App app("graspdb-lab simulates, evaluates and measures.", "graspdb");
  client::GlobalOptions global;
  client::Action action;
  client::AddGlobalFlags(app, &global);
  AddBenchCommand(app, global, &action);
  AddRobotCommand(app, global, &action);
  AddSimulateCommand(app, &action);
  AddEvalCommand(app, &action);
  return client::RunCommandLine(
      app, global, action,
      {"import", "teach", "recognize", "replay", "describe", "export", "objects", "grasps", "cells",
       "status", "sensors", "backup", "uploads", "watch", "doctor", "console"},
      argc, argv);
}

}  // namespace
}  // namespace graspdb::lab

int main(int argc, char** argv) {
  graspdb::OpenStandardStreams();
  return graspdb::WithOutputWritten("graspdb", graspdb::lab::Run(argc, argv));
}
