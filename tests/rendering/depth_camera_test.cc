#include "rendering/camera/depth_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rendering/meshes/solid.h"

namespace graspdb::rendering {
namespace {

using recognition::Pose;

DepthCamera Make(DepthCameraModel model, double noise) {
  model.noise.scale = noise;
  return *DepthCamera::Create(model);
}

const TriangleMesh& Cube() {
  static const TriangleMesh cube = BoxSolid({-0.05F, -0.05F, 0}, {0.05F, 0.05F, 0.1F});
  return cube;
}

Scene CubeOnTable() {
  Scene scene;
  scene.objects.push_back({.mesh = &Cube()});
  return scene;
}

std::size_t PixelAt(const DepthFrame& frame, int u, int v) {
  return static_cast<std::size_t>(v) * static_cast<std::size_t>(frame.width) +
         static_cast<std::size_t>(u);
}

TEST(DepthCamera, SeesTheTopOfABoxAndTheTableBesideItFromAbove) {
  const DepthCamera camera = Make(KinectV2(), 0);
  const auto frame = camera.Render(CubeOnTable(), LookAt({0, 0, 0}, 0.8, 90, -90), 1);
  ASSERT_TRUE(frame.ok()) << frame.status();
  EXPECT_NEAR(frame->depth_m[PixelAt(*frame, 256, 212)], 0.7F, 1e-5);
  EXPECT_EQ(frame->surface[PixelAt(*frame, 256, 212)], 0);
  EXPECT_NEAR(frame->depth_m[PixelAt(*frame, 100, 100)], 0.8F, 1e-5);
  EXPECT_EQ(frame->surface[PixelAt(*frame, 100, 100)], kTableSurface);
  // The top is 0.1 m wide at 0.7 m: 365.5 * 0.05 / 0.7 pixels to each side.
  EXPECT_EQ(frame->surface[PixelAt(*frame, 256 + 25, 212)], 0);
  EXPECT_EQ(frame->surface[PixelAt(*frame, 256 + 27, 212)], kTableSurface);
}

TEST(DepthCamera, TablePixelsOfASlantedViewLieOnTheTable) {
  const DepthCamera camera = Make(KinectV1(), 0);
  const Pose sensor = LookAt({0.05, -0.02, 0}, 0.8, 40, 30);
  const auto frame = camera.Render(CubeOnTable(), sensor, 1);
  ASSERT_TRUE(frame.ok());
  const recognition::Points points = ToPoints(*frame, camera.model().intrinsics);
  int on_table = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (frame->surface[i] == kNoSurface) {
      EXPECT_TRUE(points[i].array().isNaN().all());
      continue;
    }
    const Eigen::Vector3d p = sensor * points[i].cast<double>();
    if (frame->surface[i] == kTableSurface) {
      EXPECT_NEAR(p.z(), 0, 1e-5);
      ++on_table;
    } else {
      const double from_side = 0.05 - p.head<2>().cwiseAbs().maxCoeff();
      EXPECT_NEAR(std::min(std::abs(from_side), std::abs(0.1 - p.z())), 0, 1e-5);
    }
  }
  EXPECT_GT(on_table, 100000);
}

TEST(DepthFrameTest, CountsAreInUnitsAndZeroOutOfRange) {
  DepthFrame frame;
  frame.depth_m = {0, 0.8004F, 65.535F, 66};
  EXPECT_THAT(ToCounts(frame, 0.001), ::testing::ElementsAre(0, 800, 65535, 0));
  EXPECT_THAT(ToCounts(frame, 0.002), ::testing::ElementsAre(0, 400, 32768, 33000));
}

TEST(DepthCamera, LookAtGivesTheRequestedPose) {
  const Pose pose = LookAt({1, 2, 3}, 0.8, 30, -90);
  EXPECT_TRUE((pose * Eigen::Vector3d(0, 0, 0.8)).isApprox(Eigen::Vector3d(1, 2, 3), 1e-12));
  EXPECT_NEAR(pose.translation().z(), 3 + 0.4, 1e-12);
  EXPECT_NEAR(pose.translation().y(), 2 - 0.8 * std::cos(std::numbers::pi / 6), 1e-12);
  EXPECT_TRUE(pose.linear().col(0).isApprox(Eigen::Vector3d::UnitX(), 1e-12)) << "right";
  EXPECT_LT(pose.linear().col(1).z(), 0) << "down";
  EXPECT_NEAR(pose.linear().determinant(), 1, 1e-12);
  EXPECT_NEAR(LookAt({0, 0, 0}, 1, 90, 17).linear().determinant(), 1, 1e-12);
}

TEST(DepthCamera, IsDeterministicForASeed) {
  const DepthCamera camera = Make(KinectV2(), 1);
  const Pose sensor = LookAt({0, 0, 0}, 0.8, 40, -90);
  const auto first = camera.Render(CubeOnTable(), sensor, 7);
  const auto again = Make(KinectV2(), 1).Render(CubeOnTable(), sensor, 7);
  const auto other = camera.Render(CubeOnTable(), sensor, 8);
  EXPECT_EQ(first->depth_m, again->depth_m);
  EXPECT_EQ(first->surface, again->surface);
  EXPECT_NE(first->depth_m, other->depth_m);
}

TEST(DepthCamera, MeasuresNothingOutOfRangeOrWithoutATable) {
  const DepthCamera camera = Make(KinectV2(), 0);
  const auto measured = [&camera](const Scene& scene, double distance_m) {
    const auto frame = camera.Render(scene, LookAt({0, 0, 0}, distance_m, 90, 0), 1);
    return std::count_if(frame->depth_m.begin(), frame->depth_m.end(),
                         [](float z) { return z > 0; });
  };
  Scene table;
  EXPECT_EQ(measured(table, 0.45), 0);
  EXPECT_EQ(measured(table, 1), 512 * 424);
  EXPECT_EQ(measured(table, 4.6), 0);
  // A table of 2 m at 4 m is (2 / 4 * 365.5)^2 pixels.
  EXPECT_NEAR(static_cast<double>(measured(table, 4)), 182.75 * 182.75, 2 * 183);
  table.with_table = false;
  EXPECT_EQ(measured(table, 1), 0);
}

TEST(DepthCamera, LosesGrazingTablePixels) {
  Scene scene;
  scene.table_half_width_m = 4;
  const Pose sensor = LookAt({0, 0, 0}, 1, 2, -90);
  const auto ideal = Make(KinectV2(), 0).Render(scene, sensor, 1);
  const auto real = Make(KinectV2(), 1).Render(scene, sensor, 1);
  // The middle row meets the table at 88 degrees.
  for (int u = 0; u < 512; u += 50) {
    EXPECT_GT(ideal->depth_m[PixelAt(*ideal, u, 212)], 0);
    EXPECT_EQ(real->depth_m[PixelAt(*real, u, 212)], 0);
  }
}

TEST(DepthCamera, RejectsInvalidScenes) {
  const DepthCamera camera = Make(KinectV2(), 1);
  const Pose sensor = LookAt({0, 0, 0}, 0.8, 40, -90);
  Scene scene = CubeOnTable();
  scene.objects[0].mesh = nullptr;
  EXPECT_EQ(camera.Render(scene, sensor, 1).status().code(), absl::StatusCode::kInvalidArgument);
  TriangleMesh broken = Cube();
  broken.triangles[0][0] = 99;
  scene.objects[0].mesh = &broken;
  EXPECT_EQ(camera.Render(scene, sensor, 1).status().code(), absl::StatusCode::kInvalidArgument);
  Pose nowhere = sensor;
  nowhere.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(camera.Render(CubeOnTable(), nowhere, 1).status().code(),
            absl::StatusCode::kInvalidArgument);
  DepthCameraModel blind = KinectV2();
  blind.intrinsics.fx = 0;
  EXPECT_EQ(Make(blind, 1).Render(CubeOnTable(), sensor, 1).status().code(),
            absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace graspdb::rendering
