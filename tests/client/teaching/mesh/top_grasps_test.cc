#include "client/teaching/mesh/top_grasps.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "files/messages/pose_message.h"
#include "rendering/meshes/solid.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

std::vector<v1::Grasp> GraspsOf(const rendering::TriangleMesh& mesh, double max_opening_m = 0.085) {
  const recognition::Box box = rendering::BoundsOf(mesh);
  const auto center = rendering::CenterOfMass(mesh);
  return ProposeTopGrasps({&mesh, center.value_or((box.min + box.max) / 2), false},
                          {.max_opening_m = max_opening_m});
}

TEST(TopGrasps, CloseAcrossTheNarrowerSideOverTheCentreOfMass) {
  const auto grasps = GraspsOf(rendering::BoxSolid({-0.04F, -0.015F, 0}, {0.04F, 0.015F, 0.02F}));
  ASSERT_FALSE(grasps.empty());
  EXPECT_EQ(grasps[0].grasp_id(), "top");
  const Pose tcp = files::FromMessage(grasps[0].tcp_pose());
  EXPECT_NEAR(std::abs(tcp.linear().col(0).y()), 1, 1e-6);
  EXPECT_NEAR(tcp.linear().col(2).z(), -1, 1e-6) << "the tool looks down";
  EXPECT_LT(tcp.translation().head<2>().norm(), 0.003);
  EXPECT_NEAR(grasps[0].gripper_opening_m(), 0.05, 1e-3);
  ASSERT_EQ(grasps.size(), 1U) << "80 mm and the clearance of the fingers do not fit into 85 mm";
  EXPECT_EQ(GraspsOf(rendering::BoxSolid({-0.035F, -0.015F, 0}, {0.035F, 0.015F, 0.02F})).size(),
            2U);
}

TEST(TopGrasps, AnObjectWiderThanTheGripperHasNone) {
  const rendering::TriangleMesh box =
      rendering::BoxSolid({-0.05F, -0.05F, 0}, {0.05F, 0.05F, 0.05F});
  EXPECT_TRUE(GraspsOf(box).empty());
  EXPECT_FALSE(GraspsOf(box, 0.11).empty());
}

TEST(TopGrasps, AWedgeHasNoneAcrossItsSlopes) {
  // 45 degrees on both sides: the fingers would slip up.
  const rendering::TriangleMesh roof =
      rendering::ExtrudeAlongY({{-0.02F, 0}, {0.02F, 0}, {0, 0.02F}}, -0.03F, 0.03F);
  const auto grasps = GraspsOf(roof);
  ASSERT_FALSE(grasps.empty()) << "its ends can be grasped";
  for (const v1::Grasp& grasp : grasps) {
    EXPECT_GT(std::abs(files::FromMessage(grasp.tcp_pose()).linear().col(0).y()), 0.9);
  }
}

TEST(TopGrasps, TheFingersComeDownBesideTheObjectAndOffTheTable) {
  // An angle on its back: the upright leg is narrow, the lying one wide.
  const rendering::TriangleMesh angle = rendering::ExtrudeAlongX(
      {{-0.1F, 0}, {0.02F, 0}, {0.02F, 0.06F}, {0, 0.06F}, {0, 0.02F}, {-0.1F, 0.02F}}, -0.02F,
      0.02F);
  const auto grasps = GraspsOf(angle, 0.06);
  ASSERT_FALSE(grasps.empty());
  const ParallelGripper gripper;
  const recognition::Points surface = rendering::SampleSurface(angle, 20'000, 7);
  for (const v1::Grasp& grasp : grasps) {
    const Pose tcp = files::FromMessage(grasp.tcp_pose());
    const double tips = tcp.translation().z() - gripper.pad_height_m / 2;
    EXPECT_GT(tips, 0.0019);
    for (const Eigen::Vector3f& p : surface) {
      const Eigen::Vector3d q = tcp.inverse() * p.cast<double>();
      if (static_cast<double>(p.z()) < tips + 5e-4) continue;
      if (std::abs(q.y()) > gripper.finger_width_m / 2 - 5e-4) continue;
      EXPECT_LT(std::abs(q.x()), grasp.gripper_opening_m() / 2) << "a finger comes down upon it";
    }
  }
}

TEST(TopGrasps, AStandingCanHasOneAcrossItsMiddle) {
  const rendering::TriangleMesh can = rendering::CylinderSolid({0, 0}, 0.03F, 0, 0.05F);
  const auto grasps = ProposeTopGrasps({&can, {0, 0, 0.025}, true}, {});
  ASSERT_EQ(grasps.size(), 1U);
  EXPECT_LT(files::FromMessage(grasps[0].tcp_pose()).translation().head<2>().norm(), 0.002);
}

// Each triangle as four.
rendering::TriangleMesh Divided(const rendering::TriangleMesh& mesh) {
  rendering::TriangleMesh out;
  for (const std::array<int, 3>& t : mesh.triangles) {
    const auto first = static_cast<int>(out.vertices.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Vector3f& a = mesh.vertices[static_cast<std::size_t>(t[k])];
      const Eigen::Vector3f& b = mesh.vertices[static_cast<std::size_t>(t[(k + 1) % 3])];
      out.vertices.push_back(a);
      out.vertices.emplace_back((a + b) / 2);
    }
    for (const std::array<int, 3>& part :
         {std::array{0, 1, 5}, std::array{1, 2, 3}, std::array{5, 3, 4}, std::array{1, 3, 5}}) {
      out.triangles.push_back({first + part[0], first + part[1], first + part[2]});
    }
  }
  return out;
}

TEST(TopGrasps, DoNotDependOnTheTriangles) {
  const rendering::TriangleMesh angle = rendering::ExtrudeAlongX(
      {{-0.05F, 0}, {0.01F, 0}, {0.01F, 0.06F}, {-0.01F, 0.06F}, {-0.01F, 0.02F}, {-0.05F, 0.02F}},
      -0.02F, 0.02F);
  for (const rendering::TriangleMesh& part :
       {angle, rendering::BoxSolid({-0.04F, -0.015F, 0}, {0.04F, 0.015F, 0.05F}),
        rendering::CylinderSolid({0, 0}, 0.02F, 0, 0.05F)}) {
    for (const double turn_rad : {0.0, 0.2}) {
      const rendering::TriangleMesh mesh =
          rendering::Transformed(part, Pose(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ())));
      const auto grasps = GraspsOf(mesh);
      const auto divided = GraspsOf(Divided(Divided(mesh)));
      ASSERT_FALSE(grasps.empty());
      ASSERT_EQ(grasps.size(), divided.size());
      for (std::size_t i = 0; i < grasps.size(); ++i) {
        EXPECT_NEAR(grasps[i].gripper_opening_m(), divided[i].gripper_opening_m(), 1e-5);
        EXPECT_TRUE(files::FromMessage(grasps[i].tcp_pose())
                        .isApprox(files::FromMessage(divided[i].tcp_pose()), 1e-4));
      }
    }
  }
}

TEST(TopGrasps, ThePalmStaysOffATallObject) {
  const rendering::TriangleMesh tower =
      rendering::BoxSolid({-0.02F, -0.02F, 0}, {0.02F, 0.02F, 0.2F});
  const ParallelGripper gripper;
  for (const v1::Grasp& grasp : GraspsOf(tower)) {
    const double tips = grasp.tcp_pose().position().z() - gripper.pad_height_m / 2;
    EXPECT_GE(tips + gripper.finger_length_m, 0.2 - 1e-6);
  }
  EXPECT_FALSE(GraspsOf(tower).empty());
}

}  // namespace
}  // namespace graspdb::client
