// Scans as images.
#include "recognition/frame/frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "tests/recognition/scenes/taught_shapes.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::SmallCamera;
using ::graspdb::testing::TakePicture;
using ::graspdb::testing::TaughtShapes;

Box Region() { return {{-0.3, -0.3, -0.05}, {0.3, 0.3, 0.4}}; }

class FrameTest : public ::testing::Test {
 protected:
  FrameTest()
      : picture_(TakePicture({{TaughtShapes::Part("slab", 0, 0, 10)}}, TaughtShapes::WorldSensor(),
                             SmallCamera())) {
    scan_.points = picture_.points;
    scan_.width = SmallCamera().width;
  }

  Frame Make(const Scan& scan) const {
    return MakeFrame(scan, TaughtShapes::WorldSensor(), Plane(), Region(), {},
                     [] { return false; });
  }
  static std::ptrdiff_t Count(const Frame& frame, PixelRole role) {
    return std::ranges::count(frame.role, role);
  }

  const ::graspdb::testing::Picture picture_;
  Scan scan_;
};

TEST_F(FrameTest, TheCameraOfAnOrganisedCloudIsFound) {
  const Frame frame = Make(scan_);
  const CameraIntrinsics camera = SmallCamera();
  EXPECT_EQ(frame.camera.width, camera.width);
  EXPECT_EQ(frame.camera.height, camera.height);
  EXPECT_NEAR(frame.camera.fx, camera.fx, 0.01 * camera.fx);
  EXPECT_NEAR(frame.camera.cy, camera.cy, 0.5);
}

TEST_F(FrameTest, PixelsOfTheTableAndOfObjectsAreDistinguished) {
  const Frame frame = Make(scan_);
  std::size_t wrong = 0;
  std::size_t objects = 0;
  for (std::size_t i = 0; i < frame.role.size(); ++i) {
    const Eigen::Vector3d world = TaughtShapes::WorldSensor() * picture_.points[i].cast<double>();
    if (picture_.shown[i] < 0 || world.z() < 0.01) continue;
    objects += 1;
    wrong += frame.role[i] == PixelRole::kTable ? 1 : 0;
  }
  EXPECT_GT(objects, 500U);
  EXPECT_EQ(wrong, 0U);
  EXPECT_GT(Count(frame, PixelRole::kTable), 3000);
}

TEST_F(FrameTest, AroundPointsOfInterestItIsAPartOfTheImage) {
  const Frame whole = Make(scan_);
  const Eigen::Vector3f point =
      (TaughtShapes::WorldSensor().inverse() * Eigen::Vector3d::Zero()).cast<float>();
  const Frame part = MakeFrame(scan_, TaughtShapes::WorldSensor(), Plane(), Region(), {},
                               [] { return false; }, {point});
  EXPECT_GT(part.camera.width, 10);
  EXPECT_LT(part.camera.width, whole.camera.width);
  EXPECT_LT(part.camera.height, whole.camera.height);
  const auto at = static_cast<std::size_t>(part.PixelOf(point));
  const auto there = static_cast<std::size_t>(whole.PixelOf(point));
  EXPECT_EQ(part.depth[at], whole.depth[there]);
  EXPECT_EQ(part.role[at], whole.role[there]);
  EXPECT_LT((part.PointAt(at, 1) - whole.PointAt(there, 1)).norm(), 1e-5);
}

TEST_F(FrameTest, NormalsOfFacesAreTheirs) {
  const Frame frame = Make(scan_);
  const Eigen::Vector3f up =
      (TaughtShapes::WorldSensor().linear().transpose() * Eigen::Vector3d::UnitZ()).cast<float>();
  std::size_t tops = 0;
  for (std::size_t i = 0; i < frame.role.size(); ++i) {
    if (frame.normals[i].squaredNorm() > 0 && frame.normals[i].dot(up) > 0.99F) tops += 1;
  }
  EXPECT_GT(tops, 200U);
}

TEST_F(FrameTest, ADepthImageAndItsPointsGiveTheSameFrame) {
  Scan image;
  image.depth_image = {{}, SmallCamera(), 0.0001};
  for (const auto& p : scan_.points) {
    image.depth_image.depth.push_back(
        p.allFinite() ? static_cast<std::uint16_t>(std::lround(p.z() * 1e4F)) : 0);
  }
  EXPECT_NEAR(static_cast<double>(Count(Make(image), PixelRole::kObject)),
              static_cast<double>(Count(Make(scan_), PixelRole::kObject)), 10);
}

TEST_F(FrameTest, ACloudWithoutImageOrderIsRendered) {
  Scan shuffled;
  shuffled.points = scan_.points;
  std::shuffle(shuffled.points.begin(), shuffled.points.end(), std::mt19937(1));
  const Frame frame = Make(shuffled);
  const std::ptrdiff_t objects = Count(Make(scan_), PixelRole::kObject);
  // Its pixels are a little smaller, and hardly any shows two points.
  EXPECT_GT(Count(frame, PixelRole::kObject), objects * 4 / 5);
  EXPECT_LE(Count(frame, PixelRole::kObject), objects * 11 / 10);
}

TEST_F(FrameTest, PixelsBetweenTwoSurfacesAreDropped) {
  const auto first = std::ranges::find(picture_.shown, 0) - picture_.shown.begin();
  const auto middle = static_cast<std::size_t>(first + std::ptrdiff_t{5} * scan_.width);
  scan_.points[middle] *= 0.8F;
  EXPECT_EQ(Make(scan_).depth[middle], 0);
}

TEST_F(FrameTest, AWrongWidthIsNoImageOrder) {
  scan_.width = 96;
  const Frame frame = Make(scan_);
  EXPECT_NE(frame.camera.width, 96);
  EXPECT_GT(Count(frame, PixelRole::kObject), 100);
}

TEST_F(FrameTest, DepthsThatNoCameraMeasuresAreNone) {
  const auto first =
      static_cast<std::size_t>(std::ranges::find(picture_.shown, 0) - picture_.shown.begin());
  scan_.points[first] *= 1e30F / scan_.points[first].z();
  EXPECT_EQ(Make(scan_).depth[first], 0);
}

TEST_F(FrameTest, ALargeImageIsThinned) {
  Scan large;
  large.depth_image = {{}, {3000, 3000, 500, 500, 1500, 1500}, 0.001};
  large.depth_image.depth.assign(9'000'000, 700);
  EXPECT_LE(Make(large).depth.size(), 1'000'000U);
}

TEST_F(FrameTest, NothingMeasuredIsNoFrame) {
  for (auto& p : scan_.points) p.setConstant(std::numeric_limits<float>::quiet_NaN());
  const Frame frame = Make(scan_);
  EXPECT_EQ(Count(frame, PixelRole::kObject), 0);
  EXPECT_EQ(Make({}).depth.size(), 0U);
}

}  // namespace
}  // namespace graspdb::recognition
