// Teaching from a mesh with real processes.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/end_to_end/fixtures/programs_fixture.h"
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
    const rendering::TriangleMesh angle =
        rendering::ExtrudeAlongY({{0, 0}, {100, 0}, {100, 20}, {25, 20}, {25, 80}, {0, 80}}, 0, 40);
    EXPECT_THAT(rendering::WriteMeshPly(Path("angle.ply"), angle), IsOk());
    return Path("angle.ply");
  }
  std::vector<std::string> Teach(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"teach",           "angle",  "--mesh",
                                      Path("angle.ply"), "--unit", "mm"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
};

TEST_F(TeachTest, RecognizesObjectsTaughtFromAMesh) {
  WriteAngle();
  StartServer();
  const Finished taught = Graspdb(Teach({"--poses", "1,3"}));
  ASSERT_EQ(taught.exit_status, 0) << taught.err;
  EXPECT_THAT(taught.out, HasSubstr("taught 36 views, 0 were there already"));
  // The mesh in its own orientation, on the longer leg, is one of them.
  Succeed({"simulate", Path("angle.ply"), "--unit", "mm", "--random", "4", "--seed", "3", "--out",
           Path("queries")});
  EXPECT_EQ(CountRight(Recognize("queries")), 4);
}

// The vertices of the mesh are at their simulated positions in the world frame.
TEST_F(TeachTest, AnswersHaveTheFrameOfTheMesh) {
  WriteAngle();
  StartServer();
  Succeed(Teach({}));
  Succeed({"simulate", Path("angle.ply"), "--unit", "mm", "--random", "4", "--seed", "3", "--out",
           Path("queries")});
  const auto set = files::LoadCaptureSet(Path("queries"));
  ASSERT_THAT(set, IsOk());
  // In its own orientation: the middle of its bounding box is put on the z axis.
  const Eigen::Vector3d shift(-0.05, -0.02, 0);
  int measured = 0;
  std::istringstream lines(Recognize("queries"));
  for (std::string line; std::getline(lines, line);) {
    const auto response = ResponseOf(line);
    ASSERT_TRUE(response && response->detections_size() == 1) << line;
    const auto capture = std::ranges::find_if(set->captures(), [&](const v1::Capture& one) {
      return line.find(one.path()) != std::string::npos;
    });
    ASSERT_NE(capture, set->captures().end()) << line;
    const recognition::Pose truth = files::FromMessage(capture->object_pose());
    ASSERT_TRUE(response->detections(0).has_mesh_pose()) << line;
    const recognition::Pose mesh = files::FromMessage(response->detections(0).mesh_pose());
    for (const Eigen::Vector3d& v : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(0.1, 0, 0.02),
                                     Eigen::Vector3d(0, 0.04, 0.08)}) {
      EXPECT_LT((mesh * v - truth * (v + shift)).norm(), 0.006) << line;
      EXPECT_LT((mesh.inverse() * (truth * (v + shift)) - v).norm(), 0.006) << line;
    }
    ++measured;
  }
  EXPECT_EQ(measured, 4);
}

TEST_F(TeachTest, AppliesAGraspOnTheMeshToReachableStablePoses) {
  WriteAngle();
  StartServer();
  Succeed(Teach({"--step", "120"}));
  // From the mesh's +z onto its upright leg; it is not reached upside down.
  std::ofstream(Path("grasps.json"))
      << R"({"grasps":[{"graspId":"leg","approachDistanceM":0.1,"gripperOpeningM":0.06,"tcpPose":)"
      << R"({"position":{"x":0.0125,"y":0.02,"z":0.07},"orientation":{"x":1}}}]})";
  const std::vector<std::string> import = {"grasps",  "import", "angle", Path("grasps.json"),
                                           "--frame", "mesh"};
  std::vector<std::string> dry = import;
  dry.emplace_back("--dry-run");
  const auto before = Status().catalog_revision();
  EXPECT_EQ(Succeed(dry).out, Succeed(dry).out);
  EXPECT_EQ(Status().catalog_revision(), before);
  const std::string table = Succeed(import).out;
  EXPECT_THAT(table, HasSubstr("taken"));
  EXPECT_THAT(table, HasSubstr("left out: "));
  std::istringstream lines(Succeed({"grasps", "list", "angle", "--json"}).out);
  for (std::string line; std::getline(lines, line);) {
    v1::StablePose pose;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(line, &pose).ok());
    const recognition::Pose object_mesh = files::FromMessage(pose.mesh_pose());
    const auto leg = std::ranges::find(pose.grasps(), "leg", &v1::Grasp::grasp_id);
    const double up = object_mesh.linear()(2, 2);  // of the mesh's z
    const Eigen::Vector3d tcp = object_mesh * Eigen::Vector3d(0.0125, 0.02, 0.07);
    ASSERT_EQ(leg != pose.grasps().end(), up > -0.017) << line;
    if (leg == pose.grasps().end()) continue;
    EXPECT_LT((files::FromMessage(leg->tcp_pose()).translation() - tcp).norm(), 1e-6) << line;
  }
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

TEST_F(TeachTest, RejectsAnotherMeshOfTheSameName) {
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

// A recording of a turntable that turns while its views are taken: one initial frame, then five of
// each view.
TEST_F(TeachTest, RunsUnattended) {
  StartServer();
  Succeed({"cells", "set", "press", "--region", "-0.3,-0.3,-0.02,0.3,0.3,0.4"});
  Succeed(
      {"simulate", "--parts", "l-bracket", "--turntable", "--step", "60", "--out", Path("turn")});
  const auto set = files::LoadCaptureSet(Path("turn"));
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
  EXPECT_THAT(taught.out, HasSubstr("taught 6 views; the catalogue has 6 views of 1 object\n"));
  // Again with another stable pose, for which the recording ends after five views.
  std::filesystem::remove(Path("frames/130.pcd"));
  const Finished broken = Graspdb(teach);
  EXPECT_EQ(broken.exit_status, 1) << broken.out;
  EXPECT_THAT(broken.out, HasSubstr("run the same command again to go on"));
}

TEST_F(TeachTest, DryRunNeedsNoServer) {
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

TEST_F(TeachTest, NotesThatAnObjectKeepsItsDisplayName) {
  WriteAngle();
  StartServer();
  const auto teach = [&](const std::string& name) {
    const Finished taught =
        Graspdb(Teach({"--poses", "1", "--step", "120", "--display-name", name}));
    EXPECT_EQ(taught.exit_status, 0) << taught.err;
    return taught.err;
  };
  EXPECT_THAT(teach("Angle A"), Not(HasSubstr("display name")));
  EXPECT_THAT(teach("Angle A"), Not(HasSubstr("display name")));
  EXPECT_THAT(teach("Angle B"), HasSubstr("graspdb objects set angle --display-name"));
  EXPECT_THAT(Succeed({"objects", "show", "angle"}).out, HasSubstr("Angle A"));
}

TEST_F(TeachTest, AnEmptyDisplayNameRemovesTheNameOfAnObjectOrACell) {
  WriteAngle();
  StartServer();
  Succeed(Teach({"--poses", "1", "--step", "120", "--display-name", "Left angle"}));
  EXPECT_THAT(Succeed({"objects", "show", "angle"}).out, HasSubstr("Left angle"));
  Succeed({"objects", "set", "angle", "--display-name", ""});
  EXPECT_THAT(Succeed({"objects", "show", "angle"}).out, Not(HasSubstr("Left angle")));
  Succeed({"cells", "set", "press", "--display-name", "Hall 2"});
  EXPECT_THAT(Succeed({"cells", "show", "press"}).out, HasSubstr("Hall 2"));
  Succeed({"cells", "set", "press", "--display-name", ""});
  EXPECT_THAT(Succeed({"cells", "show", "press"}).out, Not(HasSubstr("Hall 2")));
}

TEST_F(TeachTest, ADryRunRejectsTheIdsThatTheServerWould) {
  WriteAngle();
  for (const std::string& id :
       {std::string("two words"), std::string("objects/angle"), std::string(64, 'a')}) {
    std::vector<std::string> words = Teach({"--dry-run"});
    words[1] = id;
    const Finished refused = Graspdb(words);
    EXPECT_EQ(refused.exit_status, 2) << id;
    EXPECT_THAT(refused.err, HasSubstr("OBJECT \"" + id + "\" is not an id"));
  }
}

TEST_F(TeachTest, UsesTheCameraOfTheCell) {
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

TEST_F(TeachTest, SuggestsTheUnitThatFits) {
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
