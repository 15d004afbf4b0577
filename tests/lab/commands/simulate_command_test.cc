#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <string>

#include "files/capture_sets/capture_set.h"
#include "lab/commands/commands.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::lab {
namespace {

using ::testing::HasSubstr;

// Output and status of a run.
struct RunOutput {
  absl::Status status;
  std::string out;
  std::string err;
};

RunOutput Simulate(const std::string& arguments) {
  CLI::App app;
  std::function<absl::Status()> action;
  AddSimulateCommand(app, &action);
  app.parse("simulate " + arguments);
  ::testing::internal::CaptureStdout();
  ::testing::internal::CaptureStderr();
  RunOutput run;
  run.status = action();
  run.out = ::testing::internal::GetCapturedStdout();
  run.err = ::testing::internal::GetCapturedStderr();
  return run;
}

TEST(SimulateCommand, WritesASetAndOneLine) {
  const files::TemporaryFolder folder;
  const std::string set = (folder.path() / "set").string();
  const RunOutput run = Simulate("--parts flange,wedge --step 90 --look-down 35,50 --out " + set);
  ASSERT_TRUE(run.status.ok()) << run.status;
  EXPECT_EQ(run.out, "wrote 16 captures of 2 objects to " + set + "\n");
  EXPECT_THAT(run.err, HasSubstr("16 of 16 captures\n"));
  const auto loaded = files::LoadCaptureSet(set);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  EXPECT_EQ(files::CapturesOf(*loaded, v1::Capture::TEACH).size(), 16U);
}

TEST(SimulateCommand, WritesTurntableAndRandomScenesToOneSet) {
  const files::TemporaryFolder folder;
  const std::string set = folder.path().string();
  ASSERT_TRUE(Simulate("--turntable --step 180 --random 3 --parts wedge --camera v1 --noise 0 "
                       "--no-table --out " +
                       set)
                  .status.ok());
  const auto loaded = files::LoadCaptureSet(set);
  EXPECT_EQ(files::CapturesOf(*loaded, v1::Capture::TEACH).size(), 2U);
  EXPECT_EQ(files::CapturesOf(*loaded, v1::Capture::QUERY).size(), 3U);
  EXPECT_EQ(Simulate("--random 1 --out " + set).status.code(), absl::StatusCode::kAlreadyExists);
  ASSERT_TRUE(Simulate("--random 2 --split TEACH --overwrite --out " + set).status.ok());
  EXPECT_EQ(files::CapturesOf(*files::LoadCaptureSet(set), v1::Capture::TEACH).size(), 2U);
}

TEST(SimulateCommand, AcceptsMeshesAndUnitAfterListOptions) {
  const files::TemporaryFolder folder;
  const auto mesh = folder.path() / "Block.ply";
  ASSERT_TRUE(rendering::WriteMeshPly(mesh, rendering::BoxSolid({0, 0, 0}, {80, 40, 30})).ok());
  const std::string set = (folder.path() / "set").string();
  const std::string rest = " --step 180 --out " + set;
  const RunOutput metres = Simulate(mesh.string() + rest);
  EXPECT_EQ(metres.status.code(), absl::StatusCode::kInvalidArgument);
  const RunOutput run = Simulate("--unit mm --look-down 40,50 " + mesh.string() + rest);
  ASSERT_TRUE(run.status.ok()) << run.status;
  EXPECT_THAT(run.out, HasSubstr("wrote 4 captures of 1 objects"));
  EXPECT_EQ(files::LoadCaptureSet(set)->objects(0).object_id(), "block");
  EXPECT_EQ(Simulate("none.stl --out x").status.code(), absl::StatusCode::kNotFound);
}

TEST(SimulateCommand, ListsTheSampleParts) {
  const RunOutput run = Simulate("--list-parts");
  EXPECT_TRUE(run.status.ok());
  EXPECT_THAT(run.out, HasSubstr("flange\tFlange with four bosses\n"));
}

TEST(SimulateCommand, RejectsWrongUsageWithAParseError) {
  for (const char* wrong : {"", "--out x --parts teapot", "--out x --unit ell", "--out x --step 0",
                            "--out x --random 0", "--out x --camera v3", "--out x --look-down 95",
                            "--out x --split BOTH", "--out x --noise -1", "--out x --colour"}) {
    CLI::App app;
    std::function<absl::Status()> action;
    AddSimulateCommand(app, &action);
    EXPECT_THROW(app.parse(std::string("simulate ") + wrong), CLI::ParseError) << wrong;
    EXPECT_FALSE(action) << wrong;
  }
}

}  // namespace
}  // namespace graspdb::lab
