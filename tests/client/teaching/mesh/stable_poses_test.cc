#include "client/teaching/mesh/stable_poses.h"

#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <numbers>

#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/client/teaching/mesh/standing.h"
#include "tests/recognition/scenes/shared_data.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::SharedData;
using ::graspdb::testing::SharedDataMissing;
using ::graspdb::testing::StatusIs;
using ::testing::DoubleNear;
using ::testing::UnorderedElementsAre;

std::vector<MeshStablePose> PosesOf(const rendering::TriangleMesh& mesh,
                                    double min_probability = 0) {
  const auto found = FindStablePoses(mesh, {.min_probability = min_probability});
  EXPECT_THAT(found, IsOk());
  return found.ok() ? found->poses : std::vector<MeshStablePose>();
}

double HeightOf(const rendering::TriangleMesh& mesh, const MeshStablePose& pose) {
  return rendering::BoundsOf(rendering::Transformed(mesh, pose.object_mesh)).max.z();
}

void ExpectStanding(const rendering::TriangleMesh& mesh, const MeshStablePose& pose) {
  EXPECT_TRUE(Stands(rendering::Transformed(mesh, pose.object_mesh)));
}

rendering::TriangleMesh Sphere(float radius) {
  rendering::TriangleMesh out;
  constexpr int kRings = 24;
  constexpr int kSectors = 48;
  for (int i = 0; i <= kRings; ++i) {
    for (int k = 0; k < kSectors; ++k) {
      const double polar = std::numbers::pi * i / kRings;
      const double turn = 2 * std::numbers::pi * k / kSectors;
      out.vertices.push_back(radius * Eigen::Vector3d(std::sin(polar) * std::cos(turn),
                                                      std::sin(polar) * std::sin(turn),
                                                      std::cos(polar))
                                          .cast<float>());
    }
  }
  for (int i = 0; i < kRings; ++i) {
    for (int k = 0; k < kSectors; ++k) {
      const int a = i * kSectors + k;
      const int b = i * kSectors + (k + 1) % kSectors;
      out.triangles.push_back({a, a + kSectors, b});
      out.triangles.push_back({b, a + kSectors, b + kSectors});
    }
  }
  return out;
}

rendering::TriangleMesh Bracket() {
  return rendering::ExtrudeAlongY(
      {{0, 0}, {0.1F, 0}, {0.1F, 0.02F}, {0.02F, 0.02F}, {0.02F, 0.1F}, {0, 0.1F}}, 0, 0.03F);
}

TEST(StablePoses, ACubeLooksTheSameOnAllItsFaces) {
  const auto poses = PosesOf(rendering::BoxSolid({0, 0, 0}, {0.05F, 0.05F, 0.05F}));
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR(poses[0].probability, 1, 1e-9);
  EXPECT_EQ(poses[0].facet_count, 6);
  EXPECT_EQ(poses[0].symmetry_order(), 4);
  EXPECT_NEAR(poses[0].tip_angle_rad, std::numbers::pi / 4, 1e-6);
  EXPECT_FALSE(poses[0].rolls);
}

TEST(StablePoses, ABoxHasThreeOfTwoFacesEach) {
  const rendering::TriangleMesh box = rendering::BoxSolid({0, 0, 0}, {0.04F, 0.07F, 0.1F});
  const auto poses = PosesOf(box);
  ASSERT_EQ(poses.size(), 3U);
  const double heights[] = {0.04, 0.07, 0.1};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(HeightOf(box, poses[i]), heights[i], 1e-6);
    EXPECT_EQ(poses[i].facet_count, 2);
    EXPECT_EQ(poses[i].symmetry_order(), 2);
    ExpectStanding(box, poses[i]);
  }
}

TEST(StablePoses, TheObjectsFrameIsOnTheTableBelowItsMiddle) {
  const rendering::TriangleMesh bracket = Bracket();
  for (const MeshStablePose& pose : PosesOf(bracket)) {
    const recognition::Box bounds =
        rendering::BoundsOf(rendering::Transformed(bracket, pose.object_mesh));
    EXPECT_NEAR(bounds.min.z(), 0, 1e-6);
    if (pose.symmetry_order() != 1) continue;
    EXPECT_NEAR(bounds.min.x(), -bounds.max.x(), 1e-6);
    EXPECT_NEAR(bounds.min.y(), -bounds.max.y(), 1e-6);
  }
}

TEST(StablePoses, AnAngleRestsOnItsBackOnItsSideAndOnBothEnds) {
  const rendering::TriangleMesh bracket = Bracket();
  const auto poses = PosesOf(bracket, 0.03);
  ASSERT_EQ(poses.size(), 3U);
  for (const MeshStablePose& pose : poses) ExpectStanding(bracket, pose);
  std::vector<double> heights;
  heights.reserve(poses.size());
  for (const MeshStablePose& pose : poses) heights.push_back(HeightOf(bracket, pose));
  EXPECT_THAT(heights, ::testing::UnorderedElementsAre(
                           ::testing::DoubleNear(0.1, 1e-5), ::testing::DoubleNear(0.03, 1e-5),
                           ::testing::DoubleNear(0.12 / std::sqrt(2.0), 1e-5)));
}

TEST(StablePoses, ACanStandsOrRolls) {
  const rendering::TriangleMesh can = rendering::CylinderSolid({0, 0}, 0.03F, 0, 0.1F);
  const auto poses = PosesOf(can);
  ASSERT_EQ(poses.size(), 2U);
  EXPECT_TRUE(poses[0].rolls);
  EXPECT_NEAR(HeightOf(can, poses[0]), 0.06, 1e-4);
  EXPECT_EQ(poses[0].symmetry_order(), 2);
  EXPECT_FALSE(poses[1].rolls);
  EXPECT_NEAR(HeightOf(can, poses[1]), 0.1, 1e-5);
  EXPECT_EQ(poses[1].symmetry_order(), 0);
  // The solid angle of both ends, as of circles.
  EXPECT_NEAR(poses[1].probability, 1 - 0.05 / std::hypot(0.03, 0.05), 2e-3);
}

TEST(StablePoses, ABallHasOne) {
  const auto poses = PosesOf(Sphere(0.03F));
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_NEAR(poses[0].probability, 1, 1e-9);
  EXPECT_TRUE(poses[0].rolls);
  EXPECT_EQ(poses[0].symmetry_order(), 0);
}

TEST(StablePoses, ATetrahedronHasOneOfThreeTurnsAboutItsCentre) {
  rendering::TriangleMesh mesh;
  const float s = 0.03F;
  mesh.vertices = {{s, s, s}, {s, -s, -s}, {-s, s, -s}, {-s, -s, s}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}};
  const auto poses = PosesOf(mesh);
  ASSERT_EQ(poses.size(), 1U);
  EXPECT_EQ(poses[0].facet_count, 4);
  EXPECT_EQ(poses[0].symmetry_order(), 3);
  const Eigen::Vector3d center = poses[0].object_mesh * Eigen::Vector3d(0, 0, 0);
  EXPECT_NEAR(center.head<2>().norm(), 0, 1e-6) << "the axis of the turns is the z axis";
  ExpectStanding(mesh, poses[0]);
}

// A bar, higher at one end, with a knee of 4 degrees below its centre of mass.
TEST(StablePoses, ARockingObjectHasTwoStablePoses) {
  const auto slope = static_cast<float>(std::tan(2 * std::numbers::pi / 180));
  const float knee = 0.1091F;
  const rendering::TriangleMesh bar = rendering::ExtrudeAlongY(
      {{0, slope * knee}, {knee, 0}, {0.2F, slope * (0.2F - knee)}, {0.2F, 0.05F}, {0, 0.03F}}, 0,
      0.04F);
  std::vector<double> tilts;  // of those that lie on the knee, degrees
  for (const MeshStablePose& pose : PosesOf(bar)) {
    const Eigen::Vector3d down = -pose.object_mesh.linear().row(2).transpose();
    if (down.z() > -0.9) continue;
    tilts.push_back(std::atan2(down.x(), -down.z()) * 180 / std::numbers::pi);
    EXPECT_FALSE(pose.rolls);
  }
  EXPECT_THAT(tilts, UnorderedElementsAre(DoubleNear(-2, 0.01), DoubleNear(2, 0.01)));
}

TEST(StablePoses, DoNotDependOnHowTheMeshLies) {
  const rendering::TriangleMesh bracket = Bracket();
  recognition::Pose turned = recognition::Pose::Identity();
  turned.rotate(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, 3).normalized()));
  const auto as_it_is = PosesOf(bracket, 0.01);
  const auto otherwise = PosesOf(rendering::Transformed(bracket, turned), 0.01);
  ASSERT_EQ(as_it_is.size(), otherwise.size());
  for (std::size_t i = 0; i < as_it_is.size(); ++i) {
    EXPECT_NEAR(as_it_is[i].probability, otherwise[i].probability, 1e-4);
    EXPECT_NEAR(as_it_is[i].tip_angle_rad, otherwise[i].tip_angle_rad, 1e-3);
  }
}

TEST(StablePoses, UprightPosesAreKeptWhateverTheirProbability) {
  const rendering::TriangleMesh bottle = rendering::BoxSolid({0, 0, 0}, {0.035F, 0.075F, 0.19F});
  const auto probable = FindStablePoses(bottle, {.min_probability = 0.05});
  ASSERT_THAT(probable, IsOk());
  EXPECT_EQ(probable->poses.size(), 2U);
  const auto upright = FindStablePoses(bottle, {.min_probability = 0.05, .stands_rad = 0.087});
  ASSERT_THAT(upright, IsOk());
  ASSERT_EQ(upright->poses.size(), 3U);
  EXPECT_LT(upright->poses.back().probability, 0.05);
  EXPECT_NEAR(upright->poses.back().tip_angle_rad, std::atan(0.035 / 0.19), 0.01);
}

TEST(StablePoses, TheMostProbablePoseIsKeptIfNoneIsLikelyEnough) {
  const auto found = FindStablePoses(rendering::BoxSolid({0, 0, 0}, {0.04F, 0.07F, 0.1F}),
                                     {.min_probability = 0.99});
  ASSERT_THAT(found, IsOk());
  ASSERT_EQ(found->poses.size(), 1U);
  EXPECT_NEAR(found->poses[0].probability + found->left_out, 1, 1e-9);
}

TEST(StablePoses, InvalidMeshesAreAnError) {
  EXPECT_THAT(FindStablePoses({}, {}), StatusIs(absl::StatusCode::kInvalidArgument));
  rendering::TriangleMesh sheet;
  sheet.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {0.1F, 0.1F, 0}, {0, 0.1F, 0}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_THAT(FindStablePoses(sheet, {}), StatusIs(absl::StatusCode::kInvalidArgument));
  rendering::TriangleMesh beyond = rendering::BoxSolid({0, 0, 0}, {0.1F, 0.1F, 0.1F});
  beyond.triangles[0][0] = 1000;
  EXPECT_THAT(FindStablePoses(beyond, {}), StatusIs(absl::StatusCode::kInvalidArgument));
}

// Real meshes, whatever their unit: their largest side counts as 10 cm.
class RealMeshTest : public ::testing::TestWithParam<const char*> {
 protected:
  void ExpectAllStand() const {
    const auto folder = SharedData(GetParam());
    if (!folder) GTEST_SKIP() << SharedDataMissing(GetParam());
    int meshes = 0;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(*folder)) {
      const std::string ending = entry.path().extension().string();
      if (ending != ".ply" && ending != ".stl" && ending != ".STL") continue;
      SCOPED_TRACE(entry.path().filename().string());
      auto mesh = rendering::LoadMesh(entry.path());
      ASSERT_THAT(mesh, IsOk());
      const recognition::Box box = rendering::BoundsOf(*mesh);
      const auto scale = static_cast<float>(0.1 / (box.max - box.min).maxCoeff());
      for (Eigen::Vector3f& v : mesh->vertices) v *= scale;
      const auto found = FindStablePoses(*mesh, {.min_probability = 0.01});
      ASSERT_THAT(found, IsOk());
      EXPECT_FALSE(found->poses.empty());
      double sum = found->left_out;
      for (const MeshStablePose& pose : found->poses) sum += pose.probability;
      EXPECT_NEAR(sum, 1, 1e-6);
      if (found->mass.of_hull) continue;
      for (const MeshStablePose& pose : found->poses) ExpectStanding(*mesh, pose);
      ++meshes;
    }
    EXPECT_GT(meshes, 5);
  }
};

TEST_P(RealMeshTest, StandsInAllItsStablePoses) { ExpectAllStand(); }

INSTANTIATE_TEST_SUITE_P(SharedData, RealMeshTest,
                         ::testing::Values("industrial_meshes", "ycb_meshes"),
                         [](const auto& test) { return std::string(test.param); });

}  // namespace
}  // namespace graspdb::client
