// Teaching from a mesh with real processes.
#include <gmock/gmock.h>

#include <filesystem>

#include "client/files/capture_set.h"
#include "client/simulation/mesh_file.h"
#include "client/simulation/solid.h"
#include "tests/end_to_end/programs_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::end_to_end {
namespace {

using ::graspdb::testing::IsOk;
using ::testing::HasSubstr;
using ::testing::Not;

class TeachTest : public ProgramsTest {
 protected:
  // An angle of 10 x 8 x 4 cm, in millimetres.
  std::string WriteAngle() const {
    const client::TriangleMesh angle =
        client::ExtrudeAlongY({{0, 0}, {100, 0}, {100, 20}, {25, 20}, {25, 80}, {0, 80}}, 0, 40);
    EXPECT_THAT(client::WriteMeshPly(Path("angle.ply"), angle), IsOk());
    return Path("angle.ply");
  }
  std::vector<std::string> Teach(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"teach",           "angle",  "--mesh",
                                      Path("angle.ply"), "--unit", "mm"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(TeachTest, WhatWasTaughtFromAMeshIsRecognised) {
  WriteAngle();
  StartServer();
  const Finished taught = Graspdb(Teach({"--poses", "1,3"}));
  ASSERT_EQ(taught.exit_status, 0) << taught.err;
  EXPECT_THAT(taught.out, HasSubstr("taught 36 views, 0 were there already"));
  // The mesh as it lies, on the longer leg, is one of them.
  Succeed({"simulate", Path("angle.ply"), "--unit", "mm", "--random", "4", "--seed", "3", "--out",
           Path("ask")});
  EXPECT_EQ(CountRight(Recognize("ask")), 4);
}

TEST_F(TeachTest, TeachingTwiceChangesNothing) {
  WriteAngle();
  StartServer();
  ASSERT_EQ(Graspdb(Teach({"--step", "60"})).exit_status, 0);
  const auto before = Status();
  const Finished again = Graspdb(Teach({"--step", "60"}));
  EXPECT_EQ(again.exit_status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("taught 0 views"));
  EXPECT_EQ(Status().catalog_revision(), before.catalog_revision());
  // Half the step has the views of the whole one.
  const Finished finer = Graspdb(Teach({"--step", "30", "--poses", "1"}));
  EXPECT_THAT(finer.out, HasSubstr("taught 6 views, 6 were there already"));
}

TEST_F(TeachTest, AnotherMeshOfTheSameNameIsNotMixedIn) {
  WriteAngle();
  StartServer();
  ASSERT_EQ(Graspdb(Teach({"--step", "60", "--poses", "1"})).exit_status, 0);
  const Finished other = Graspdb(Teach({"--step", "60", "--poses", "1", "--distance", "1.0"}));
  EXPECT_EQ(other.exit_status, 1);
  EXPECT_THAT(other.err, HasSubstr("--add"));
  EXPECT_EQ(Status().view_count(), 6);
  EXPECT_EQ(
      Graspdb(Teach({"--step", "60", "--poses", "1", "--distance", "1.0", "--add"})).exit_status,
      0);
  EXPECT_EQ(Status().view_count(), 12);
}

// A turntable that turns on while its views are taken, by a recording: a frame to begin with, then
// five of each view.
TEST_F(TeachTest, NobodyNeedsToBeAtTheTerminal) {
  StartServer();
  Succeed({"cells", "set", "press", "--region", "-0.3,-0.3,-0.02,0.3,0.3,0.4"});
  Succeed(
      {"simulate", "--parts", "l-bracket", "--turntable", "--step", "60", "--out", Path("turn")});
  const auto set = client::LoadCaptureSet(Path("turn"));
  ASSERT_THAT(set, IsOk());
  ASSERT_EQ(set->captures_size(), 6);
  std::filesystem::create_directory(Path("frames"));
  const auto copy = [&](int capture, int number) {
    std::filesystem::copy_file(folder_.path() / "turn" / set->captures(capture).path(),
                               Path("frames/" + std::to_string(number) + ".pcd"));
  };
  copy(0, 100);
  for (int frame = 0; frame < 30; ++frame) copy(frame / 5, 101 + frame);
  const std::vector<std::string> teach = {
      "teach",  "l-bracket", "--sensor", "files:" + Path("frames"),
      "--cell", "press",     "--step",   "60",
      "--yes",  "--settle",  "0.01"};
  const Finished taught = Succeed(teach);
  EXPECT_THAT(taught.out, HasSubstr("taught 6 views; the catalogue has 6 views of 1 objects\n"));
  // Once more: another stable pose, for which nothing of the recording is left after five views.
  std::filesystem::remove(Path("frames/130.pcd"));
  const Finished broken = Graspdb(teach);
  EXPECT_EQ(broken.exit_status, 1) << broken.out;
  EXPECT_THAT(broken.out, HasSubstr("run the same command again to go on"));
}

TEST_F(TeachTest, ADryRunNeedsNoServer) {
  WriteAngle();
  const Finished table = Graspdb(Teach({"--dry-run", "--pictures", Path("pictures")}));
  EXPECT_EQ(table.exit_status, 0) << table.err;
  EXPECT_THAT(table.out, HasSubstr("resting-1"));
  EXPECT_THAT(table.out, HasSubstr("top (opens"));
  EXPECT_TRUE(std::filesystem::exists(Path("pictures/angle-resting-1.png")));
  const Finished json = Graspdb(Teach({"--dry-run", "--json", "--poses", "1"}));
  EXPECT_THAT(json.out, HasSubstr("\"stablePoseId\":\"resting-1\""));
  EXPECT_THAT(json.out, Not(HasSubstr("resting-2")));
}

TEST_F(TeachTest, TheCellsCameraTakesTheViews) {
  WriteAngle();
  StartServer();
  EXPECT_THAT(Graspdb(Teach({"--cell", "press"})).err, HasSubstr("press"));
  Succeed({"cells", "set", "press"});
  const Finished uncalibrated = Graspdb(Teach({"--cell", "press"}));
  EXPECT_EQ(uncalibrated.exit_status, 1);
  EXPECT_THAT(uncalibrated.err, HasSubstr("calibrate"));
  // 0.9 m above the place (0.5, 0.1), looking straight down.
  Succeed({"cells", "set", "press", "--sensor-pose", "0.5,0.1,0.9,1,0,0,0"});
  const Finished taught = Graspdb(Teach({"--cell", "press", "--step", "90", "--poses", "1"}));
  EXPECT_EQ(taught.exit_status, 0) << taught.err;
  EXPECT_EQ(Status().view_count(), 4);
}

TEST_F(TeachTest, AWrongUnitIsToldWithTheOneThatFits) {
  WriteAngle();
  const Finished wrong =
      Graspdb({"teach", "angle", "--mesh", Path("angle.ply"), "--unit", "m", "--dry-run"});
  EXPECT_EQ(wrong.exit_status, 1);
  EXPECT_THAT(wrong.err, HasSubstr("100 m large"));
  EXPECT_THAT(wrong.err, HasSubstr("mm"));
  EXPECT_EQ(Graspdb({"teach", "angle", "--mesh", Path("angle.ply")}).exit_status, 2)
      << "a unit is never guessed";
}

}  // namespace
}  // namespace graspdb::end_to_end
