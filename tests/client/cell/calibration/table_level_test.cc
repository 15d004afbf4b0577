#include "client/cell/calibration/table_level.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>

#include "recognition/base/units.h"
#include "rendering/camera/depth_camera.h"
#include "tests/rendering/small_kinect.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;

recognition::Points EmptyTable(const Pose& world_sensor) {
  const rendering::DepthCameraModel model = graspdb::testing::SmallKinectV2();
  const auto camera = rendering::DepthCamera::Create(model);
  EXPECT_THAT(camera, IsOk());
  const auto frame = camera->Render(rendering::Scene(), world_sensor, 7);
  EXPECT_THAT(frame, IsOk());
  return rendering::ToPoints(*frame, model.intrinsics);
}

Pose Tilted(const Pose& pose, double angle, const Vector3d& axis, const Vector3d& shift) {
  Pose out = Pose::Identity();
  out.linear() = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
  out.translation() = shift;
  return out * pose;
}

TEST(TableLevelTest, SetsHeightAndLevelAndKeepsTheRest) {
  const Pose truth = rendering::LookAt(Vector3d(0.1, 0.2, 0), 0.8, 50, 20);
  const auto table = FindTable(EmptyTable(truth));
  ASSERT_THAT(table, IsOk());
  EXPECT_GT(table->share, 0.95);
  EXPECT_GT(table->rms_m, 0.0005);
  EXPECT_LT(table->rms_m, 0.003);
  // As if measured by hand: 2 degrees off the level, 3 cm too high.
  const Pose before =
      Tilted(truth, 2 * recognition::kRadiansPerDegree, Vector3d::UnitX(), {0, 0, 0.03});
  const auto level = LevelOn(*table, before);
  ASSERT_THAT(level, IsOk());
  EXPECT_NEAR(level->translation().z(), truth.translation().z(), 0.0005);
  EXPECT_LT((level->translation() - before.translation()).head<2>().norm(), 1e-12);
  EXPECT_LT(Eigen::AngleAxisd(level->linear().transpose() * truth.linear()).angle(),
            0.1 * recognition::kRadiansPerDegree);
  const LevelError off = LevelErrorOf(*table, before);
  EXPECT_NEAR(off.tilt_rad, 2 * recognition::kRadiansPerDegree,
              0.05 * recognition::kRadiansPerDegree);
  EXPECT_LT(LevelErrorOf(*table, *level).tilt_rad, 1e-9);
  EXPECT_NEAR(LevelErrorOf(*table, *level).height_m, 0, 1e-9);
}

TEST(TableLevelTest, ALoweredCameraMeasuresTheTableHigher) {
  const Pose truth = rendering::LookAt(Vector3d(0.1, 0.2, 0), 0.8, 50, 20);
  const auto table = FindTable(EmptyTable(truth));
  ASSERT_THAT(table, IsOk());
  Pose estimated = *LevelOn(*table, truth);
  estimated.translation().z() += 0.012;
  const LevelError off = LevelErrorOf(*table, estimated);
  EXPECT_NEAR(off.height_m, 0.012, 1e-9);
  EXPECT_LT(off.tilt_rad, 1e-9);
}

TEST(TableLevelTest, WithoutAPoseTheOriginIsUnderTheImageCentre) {
  const Pose truth = rendering::LookAt(Vector3d::Zero(), 0.8, 50, -90);
  const auto table = FindTable(EmptyTable(truth));
  ASSERT_THAT(table, IsOk());
  const auto level = LevelOn(*table, std::nullopt);
  ASSERT_THAT(level, IsOk());
  EXPECT_LT((level->translation() - truth.translation()).norm(), 0.002);
}

TEST(TableLevelTest, InvalidTablesAreRejected) {
  EXPECT_THAT(FindTable({}), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("clear")));
  const Pose along = rendering::LookAt(Vector3d::Zero(), 0.8, 10, -90);
  EXPECT_THAT(FindTable(EmptyTable(along)),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("at most 75")));
  const Pose truth = rendering::LookAt(Vector3d::Zero(), 0.8, 50, -90);
  const auto table = FindTable(EmptyTable(truth));
  ASSERT_THAT(table, IsOk());
  EXPECT_THAT(LevelOn(*table, Tilted(truth, 20 * recognition::kRadiansPerDegree, Vector3d::UnitY(),
                                     Vector3d::Zero())),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("not its table")));
}

}  // namespace
}  // namespace graspdb::client
