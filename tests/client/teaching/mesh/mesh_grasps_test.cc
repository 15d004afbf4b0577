#include "client/teaching/mesh/mesh_grasps.h"

#include <gmock/gmock.h>

#include <fstream>
#include <numbers>

#include "files/messages/pose_message.h"
#include "rendering/workpiece.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using recognition::Pose;
using ::testing::HasSubstr;

// A grasp from above at `height_m`, with an approach of 0.1 m.
v1::Grasp Above(double height_m) {
  return rendering::TopGrasp("top", {0.01, 0.02, height_m}, 0, 0.05);
}

Pose Rolled(double degrees, double height_m) {
  Pose pose = Pose::Identity();
  pose.translation().z() = height_m;
  pose.rotate(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, Eigen::Vector3d::UnitX()));
  return pose;
}

TEST(MeshGrasps, OnlyGraspsFromAboveAndFromTheSideAreReachable) {
  EXPECT_EQ(WhyOutOfReach(Above(0.05)), "");
  EXPECT_EQ(WhyOutOfReach(FromMesh(Above(0.05), Rolled(90, 0.1))), "");
  EXPECT_EQ(WhyOutOfReach(FromMesh(Above(0.05), Rolled(180, 0.2))), "comes from below");
  EXPECT_EQ(WhyOutOfReach(FromMesh(Above(0.05), Rolled(95, 0.2))), "comes from below");
  EXPECT_THAT(WhyOutOfReach(Above(0.001)), HasSubstr("1.0 mm"));
  EXPECT_EQ(WhyOutOfReach(Above(0.003)), "");
  EXPECT_THAT(WhyOutOfReach(FromMesh(Above(0.05), Rolled(90.9, -0.0162))), HasSubstr("begins"));
}

TEST(MeshGrasps, FromMeshTransformsTheGrasp) {
  const Pose object_mesh = Rolled(90, 0.1);
  const Pose tcp = files::FromMessage(FromMesh(Above(0.05), object_mesh).tcp_pose());
  EXPECT_LT((tcp.translation() - Eigen::Vector3d(0.01, -0.05, 0.12)).norm(), 1e-9);
  EXPECT_LT((tcp.linear().col(2) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-9);
}

TEST(MeshGrasps, MergedReplacesGraspsOfTheSameId) {
  v1::Grasp side = Above(0.05);
  side.set_grasp_id("side");
  const auto merged = Merged({Above(0.05), side}, {Above(0.08)});
  ASSERT_EQ(merged.size(), 2U);
  EXPECT_EQ(merged[0].grasp_id(), "top");
  EXPECT_EQ(merged[0].tcp_pose().position().z(), 0.08);
  EXPECT_EQ(merged[1].grasp_id(), "side");
}

TEST(MeshGrasps, AFreeTurnIsRejectedInTheMeshFrame) {
  v1::Grasp turning = Above(0.05);
  EXPECT_THAT(CheckForMesh({turning}), IsOk());
  turning.mutable_free_turn()->set_max_deg(90);
  EXPECT_THAT(CheckForMesh({turning}).message(), HasSubstr("--frame object"));
}

class GraspsFileTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::vector<v1::Grasp>> Load(const std::string& text) {
    std::ofstream(folder_.path() / "grasps.json") << text;
    return LoadGrasps(folder_.path() / "grasps.json");
  }

  files::TemporaryFolder folder_;
};

constexpr char kTop[] =
    R"({"graspId":"top","tcpPose":{"position":{"z":0.1},"orientation":{"x":1}}})";

TEST_F(GraspsFileTest, GraspsAreRead) {
  const auto grasps = Load(std::string(R"({"grasps":[)") + kTop + "]}");
  ASSERT_THAT(grasps, IsOk());
  ASSERT_EQ(grasps->size(), 1U);
  EXPECT_EQ(grasps->front().tcp_pose().position().z(), 0.1);
}

TEST_F(GraspsFileTest, AByteOrderMarkIsSkipped) {
  EXPECT_THAT(Load(std::string("\xEF\xBB\xBF{\"grasps\":[") + kTop + "]}"), IsOk());
  EXPECT_THAT(Load(std::string("{\0\n\0", 4)).status().message(), HasSubstr("encoding UTF-16"));
}

TEST_F(GraspsFileTest, ErrorsNameTheProblem) {
  const std::string top = kTop;
  EXPECT_THAT(LoadGrasps(folder_.path() / "none").status().message(), HasSubstr("not exist"));
  EXPECT_THAT(Load("").status().message(), HasSubstr("grasps"));
  EXPECT_THAT(Load("{").status().message(), HasSubstr("is not {"));
  EXPECT_THAT(Load(R"({"grasp":[]})").status().message(), HasSubstr("grasp"));
  EXPECT_THAT(Load(R"({"grasps":[]})").status().message(), HasSubstr("has no grasps"));
  EXPECT_THAT(Load(R"({"grasps":[)" + top + "," + top + "]}").status().message(),
              HasSubstr("grasps[1].graspId"));
  EXPECT_THAT(Load(R"({"grasps":[{"graspId":"a b","tcpPose":{"position":{"z":0.1},)"
                   R"("orientation":{"x":1}}}]})")
                  .status()
                  .message(),
              HasSubstr("grasps[0].graspId \"a b\" is not an id"));
  EXPECT_THAT(Load(R"({"grasps":[{"graspId":"a"}]})").status().message(),
              HasSubstr("grasps[0].tcpPose"));
  EXPECT_THAT(Load(R"({"grasps":[{"graspId":"a","tcpPose":{"position":{"z":50},)"
                   R"("orientation":{"x":1}}}]})")
                  .status()
                  .message(),
              HasSubstr("grasps[0] has a length of 50 m"));
  EXPECT_THAT(Load(std::string(kMaxGraspsFileBytes + 1, ' ')).status().message(),
              HasSubstr("1 MiB"));
}

}  // namespace
}  // namespace graspdb::client
