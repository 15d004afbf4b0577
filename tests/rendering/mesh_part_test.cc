#include "rendering/mesh_part.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "files/messages/pose_message.h"
#include "rendering/meshes/mesh_file.h"
#include "rendering/meshes/solid.h"
#include "tests/files/temporary_folder.h"

namespace graspdb::rendering {
namespace {

TEST(MeshPart, KeepsItsOrientationAndIsGraspedAcrossTheNarrowSide) {
  const files::TemporaryFolder folder;
  const auto path = folder.path() / "My Part #2.ply";
  ASSERT_TRUE(WriteMeshPly(path, BoxSolid({100, 10, -40}, {180, 40, -20})).ok());
  const auto part = WorkpieceFromMesh(path, 0.001);
  ASSERT_TRUE(part.ok()) << part.status();
  EXPECT_EQ(part->object_id, "my-part--2");
  EXPECT_EQ(part->display_name, "My Part #2");
  EXPECT_TRUE(BoundsOf(part->mesh).min.isApprox(Eigen::Vector3d(-0.04, -0.015, 0), 1e-5));
  EXPECT_TRUE(BoundsOf(part->mesh).max.isApprox(Eigen::Vector3d(0.04, 0.015, 0.02), 1e-5));
  ASSERT_EQ(part->grasps.size(), 1U);
  const recognition::Pose tcp = files::FromMessage(part->grasps[0].tcp_pose());
  EXPECT_NEAR(std::abs(tcp.linear().col(0).y()), 1, 1e-9);
  EXPECT_NEAR(part->grasps[0].gripper_opening_m(), 0.05, 1e-6);
}

TEST(MeshPart, DetectsAWrongUnitFromTheSize) {
  const files::TemporaryFolder folder;
  const auto path = folder.path() / "part.ply";
  ASSERT_TRUE(WriteMeshPly(path, BoxSolid({0, 0, 0}, {80, 30, 20})).ok());
  for (const double unit : {1.0, 0.000001}) {
    const auto part = WorkpieceFromMesh(path, unit);
    EXPECT_EQ(part.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(part.status().message()), testing::HasSubstr("name its unit"));
  }
}

TEST(MeshPart, AMeshInMetresIsAtMostAsLargeAsAnObject) {
  const files::TemporaryFolder folder;
  const auto path = folder.path() / "part.ply";
  ASSERT_TRUE(WriteMeshPly(path, BoxSolid({0, 0, 0}, {0.9F, 0.03F, 0.02F})).ok());
  const auto metres = LoadMeshInMetres(path);
  ASSERT_TRUE(metres.ok()) << metres.status();
  EXPECT_EQ(metres->triangles.size(), 12U);
  for (const float unit : {1000.0F, 0.001F}) {
    const TriangleMesh box = BoxSolid({0, 0, 0}, {0.08F * unit, 0.03F * unit, 0.02F * unit});
    ASSERT_TRUE(WriteMeshPly(path, box).ok());
    const auto wrong = LoadMeshInMetres(path);
    EXPECT_EQ(wrong.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(wrong.status().message()), testing::HasSubstr("must be in metres"));
  }
}

}  // namespace
}  // namespace graspdb::rendering
