#include "client/teaching/upload/cad_views.h"

#include <gmock/gmock.h>

#include "client/teaching/mesh/cad_part.h"
#include "files/messages/pose_message.h"
#include "rendering/meshes/solid.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::IsOk;
using ::graspdb::testing::StatusIs;
using recognition::Pose;

v1::Cell CellWith(const Pose& world_sensor) {
  v1::Cell cell;
  cell.set_name("cells/press");
  *cell.mutable_sensor_pose() = files::ToMessage(world_sensor);
  return cell;
}

TEST(StandOf, TheCameraKeepsItsAngleItsDistanceAndItsRoll) {
  Pose sensor = rendering::LookAt({0.4, -0.2, 0}, 0.9, 55, 30);
  sensor.rotate(Eigen::AngleAxisd(0.7, Vector3d::UnitZ()));
  const auto stand = StandOf(CellWith(sensor));
  ASSERT_THAT(stand, IsOk());
  EXPECT_TRUE(stand->linear().isApprox(sensor.linear(), 1e-9));
  EXPECT_TRUE(stand->translation().isApprox(sensor.translation() - Vector3d(0.4, -0.2, 0), 1e-9));
  EXPECT_NEAR(stand->translation().norm(), 0.9, 1e-9);
}

TEST(StandOf, ObjectsStandInTheRegionWhereTheCameraLooksBesideIt) {
  v1::Cell cell = CellWith(rendering::LookAt({0.4, -0.2, 0}, 0.9, 55, 30));
  cell.mutable_region_of_interest()->mutable_min()->set_x(0.6);
  cell.mutable_region_of_interest()->mutable_max()->set_x(1.0);
  cell.mutable_region_of_interest()->mutable_min()->set_y(-0.1);
  cell.mutable_region_of_interest()->mutable_max()->set_y(0.1);
  const auto stand = StandOf(cell);
  ASSERT_THAT(stand, IsOk());
  const Vector3d moved =
      files::FromMessage(cell.sensor_pose()).translation() - stand->translation();
  EXPECT_TRUE(moved.isApprox(Vector3d(0.8, 0, 0), 1e-9));
}

TEST(StandOf, WithoutACalibratedCameraThatSeesTheTableItIsAnError) {
  EXPECT_THAT(StandOf({}), StatusIs(absl::StatusCode::kFailedPrecondition));
  Pose level = rendering::LookAt({0, 0, 0.5}, 0.9, 0, 30);
  EXPECT_THAT(StandOf(CellWith(level)), StatusIs(absl::StatusCode::kFailedPrecondition));
}

TEST(CadPart, StablePosesAreChosenByNumber) {
  const rendering::TriangleMesh box = rendering::BoxSolid({0, 0, 0}, {0.03F, 0.05F, 0.08F});
  const auto part = ProposeCadPart("box", "A box", box, {});
  ASSERT_THAT(part, IsOk());
  ASSERT_EQ(part->workpieces.size(), 3U);
  EXPECT_EQ(part->workpieces[0].symmetry_order, 2);
  EXPECT_FALSE(part->workpieces[0].grasps.empty());
  const auto chosen = Select(*part, {3, 1, 3});
  ASSERT_THAT(chosen, IsOk());
  ASSERT_EQ(chosen->workpieces.size(), 2U);
  EXPECT_EQ(chosen->workpieces[0].stable_pose_id, "resting-3");
  EXPECT_NEAR(rendering::BoundsOf(chosen->workpieces[0].mesh).max.z(), 0.08, 1e-6);
  EXPECT_THAT(Select(*part, {4}), StatusIs(absl::StatusCode::kInvalidArgument));
  EXPECT_THAT(Select(*part, {0}), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST(CountOf, IsOfAllStepsBelowAWholeTurnAndZeroWhereThereIsNone) {
  const std::vector<rendering::Workpiece> parts(2);
  EXPECT_EQ(CountOf(parts, {.step_deg = 20}), 36U);
  EXPECT_EQ(CountOf(parts, {.step_deg = 7}), 104U);
  EXPECT_EQ(CountOf(parts, {.step_deg = 0}), 0U);
  EXPECT_EQ(CountOf(parts, {.step_deg = -20}), 0U);
}

}  // namespace
}  // namespace graspdb::client
