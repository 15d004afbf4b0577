#include "rendering/sample_parts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <string>

#include "files/messages/pose_message.h"
#include "rendering/meshes/solid.h"
#include "tests/rendering/mesh_measure.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::rendering {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

const std::vector<Workpiece>& EveryPart() {
  static const std::vector<Workpiece> parts = SampleParts();
  return parts;
}

const Workpiece& PartNamed(const std::string& id) {
  return *std::find_if(EveryPart().begin(), EveryPart().end(),
                       [&id](const Workpiece& p) { return p.object_id == id; });
}

recognition::Pose Turn(double deg) {
  return recognition::Pose(
      Eigen::AngleAxisd(deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
}

// The largest distance of a surface, turned about z, to another one; stops once
// it is over `enough`.
float Misfit(const TriangleMesh& mesh, double turn_deg, const TriangleMesh& other, float enough) {
  float worst = 0;
  const Eigen::Matrix3f turn = Turn(turn_deg).linear().cast<float>();
  for (const Eigen::Vector3f& p : SampleSurface(mesh, 400, 11)) {
    worst = std::max(worst, DistanceTo(other, turn * p));
    if (worst > enough) break;
  }
  return worst;
}

TEST(SampleParts, HaveDistinctNames) {
  std::set<std::string> ids;
  for (const Workpiece& part : EveryPart()) ids.insert(part.object_id);
  EXPECT_GE(EveryPart().size(), 10U);
  EXPECT_EQ(ids.size(), EveryPart().size());
}

TEST(SampleParts, AreClosedSolidsOfTheRightSizeOnTheTable) {
  for (const Workpiece& part : EveryPart()) {
    SCOPED_TRACE(part.object_id);
    EXPECT_TRUE(CheckMesh(part.mesh).ok());
    EXPECT_TRUE(IsClosed(part.mesh));
    EXPECT_GT(VolumeOf(part.mesh), 0) << "inside out";
    EXPECT_NEAR(BoundsOf(part.mesh).min.z(), 0, 1e-9);
    EXPECT_GE(DiameterOf(part.mesh), 0.04);
    EXPECT_LE(DiameterOf(part.mesh), 0.16);
    EXPECT_FALSE(part.display_name.empty());
    EXPECT_FALSE(part.stable_pose_id.empty());
  }
}

// The centre of mass is over the origin, and more than 3 mm inside the convex hull of the contact
// points with the table.
TEST(SampleParts, RestStably) {
  for (const Workpiece& part : EveryPart()) {
    SCOPED_TRACE(part.object_id);
    const auto center = CenterOfMass(part.mesh);
    ASSERT_TRUE(center.ok());
    EXPECT_NEAR(center->head<2>().norm(), 0, 1e-6);
    for (int deg = 0; deg < 360; deg += 5) {
      const Eigen::Vector3d out = Turn(deg).linear().col(0);
      double reach = -1;
      for (const Eigen::Vector3f& v : part.mesh.vertices) {
        if (v.z() < 1e-6F) reach = std::max(reach, out.dot(v.cast<double>()));
      }
      EXPECT_GT(reach, 0.003) << "tips over at " << deg;
    }
  }
}

TEST(SampleParts, HaveExactlyTheDeclaredSymmetries) {
  std::map<int, int> orders;
  for (const Workpiece& part : EveryPart()) {
    SCOPED_TRACE(part.object_id);
    ++orders[part.symmetry_order];
    const int n = part.symmetry_order == 0 ? 24 : part.symmetry_order;
    for (int deg = 15; deg < 360; deg += 15) {
      const bool is_symmetric = (deg * n) % 360 == 0;
      const float misfit = Misfit(part.mesh, deg, part.mesh, 0.0031F);
      if (is_symmetric) {
        EXPECT_LT(misfit, 0.0003F) << deg;
      } else {
        EXPECT_GT(misfit, 0.003F) << deg;
      }
    }
  }
  EXPECT_GE(orders.size(), 3U);
  EXPECT_GE(orders[1], 8);
}

TEST(SampleParts, HaveDistinctShapesInAnyRotation) {
  for (const Workpiece& a : EveryPart()) {
    for (const Workpiece& b : EveryPart()) {
      if (&a == &b) continue;
      for (int deg = 0; deg < 360; deg += 15) {
        const float misfit =
            std::max(Misfit(a.mesh, deg, b.mesh, 0.008F), Misfit(b.mesh, -deg, a.mesh, 0.008F));
        EXPECT_GT(misfit, 0.008F) << a.object_id << " as " << b.object_id << " at " << deg;
      }
    }
  }
}

TEST(SampleParts, IncludeMirrorImages) {
  const Workpiece& left = PartNamed("bracket-left");
  const Workpiece& right = PartNamed("bracket-right");
  EXPECT_LT(Misfit(MirroredX(left.mesh), 0, right.mesh, 1), 1e-5F);
  ASSERT_EQ(left.grasps.size(), right.grasps.size());
  for (std::size_t i = 0; i < left.grasps.size(); ++i) {
    const v1::Vector3& a = left.grasps[i].tcp_pose().position();
    const v1::Vector3& b = right.grasps[i].tcp_pose().position();
    EXPECT_NEAR(a.x(), -b.x(), 1e-6);
    EXPECT_NEAR(a.y(), b.y(), 1e-6);
  }
}

// From above, with the fingers on both sides of some material and none in their way.
TEST(SampleParts, HaveGraspsThatHoldThePart) {
  for (const Workpiece& part : EveryPart()) {
    SCOPED_TRACE(part.object_id);
    ASSERT_FALSE(part.grasps.empty());
    for (const v1::Grasp& grasp : part.grasps) {
      SCOPED_TRACE(grasp.grasp_id());
      ASSERT_TRUE(files::CheckPose(grasp.tcp_pose(), "tcpPose").ok());
      const recognition::Pose tcp = files::FromMessage(grasp.tcp_pose());
      EXPECT_TRUE(tcp.linear().col(2).isApprox(-Eigen::Vector3d::UnitZ(), 1e-9));
      EXPECT_GT(grasp.approach_distance_m(), 0);
      const Eigen::Vector3f at = tcp.translation().cast<float>();
      const Eigen::Vector3f closing = tcp.linear().col(0).cast<float>();
      const auto half = static_cast<float>(grasp.gripper_opening_m() / 2);
      EXPECT_GT(at.z(), 0);
      EXPECT_LT(at.z(), BoundsOf(part.mesh).max.z());
      for (const float side : {-1.0F, 1.0F}) {
        const float gap = DistanceTo(part.mesh, at + side * half * closing);
        EXPECT_GT(gap, 0.004F) << "a finger touches";
        EXPECT_LT(gap, 0.015F) << "the fingers are too far open";
      }
    }
  }
}

TEST(SampleParts, AreSelectedByIdInTheirOwnOrder) {
  const auto chosen = SampleParts({"z-bar", "flange"});
  ASSERT_THAT(chosen, IsOk());
  ASSERT_EQ(chosen->size(), 2);
  EXPECT_EQ((*chosen)[0].object_id, "flange");
  EXPECT_EQ((*chosen)[1].object_id, "z-bar");
  EXPECT_EQ(SampleParts({})->size(), SampleParts().size());
}

TEST(SampleParts, ListsTheKnownIdsForAnUnknownOne) {
  EXPECT_THAT(SampleParts({"flange", "teapot"}),
              StatusIs(absl::StatusCode::kInvalidArgument,
                       AllOf(HasSubstr("teapot"), HasSubstr("post-plate"))));
}

}  // namespace
}  // namespace graspdb::rendering
