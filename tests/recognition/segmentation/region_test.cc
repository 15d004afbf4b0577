#include "recognition/segmentation/region.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "tests/recognition/scenes/synthetic_clouds.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPose;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(RegionTest, NoDepthIsNoMeasurement) {
  EXPECT_FALSE(IsMeasurement({0, 0, 0}));
  EXPECT_FALSE(IsMeasurement({-0.0F, 0, -0.0F}));
  EXPECT_FALSE(IsMeasurement({kNan, kNan, kNan}));
  EXPECT_FALSE(IsMeasurement({1, kNan, 1}));
  EXPECT_FALSE(IsMeasurement({1, 1, kInfinity}));
  EXPECT_FALSE(IsMeasurement({-kInfinity, 1, 1}));
}

TEST(RegionTest, AnyFinitePointOffTheSensorIsAMeasurement) {
  EXPECT_TRUE(IsMeasurement({0, 0, 0.5F}));
  EXPECT_TRUE(IsMeasurement({0, 1e-30F, 0}));
}

TEST(RegionTest, InvalidPointsAreDroppedAndIndicesStayRight) {
  const Points scan = {{kNan, 0, 1}, {1, 2, 3}, {0, 0, 0}, {4, 5, 6}, {0, kInfinity, 0}};
  const RegionPoints cropped = CropToRegion(scan, Pose::Identity(), std::nullopt);
  EXPECT_THAT(cropped.indices, ElementsAre(1, 3));
  EXPECT_THAT(cropped.points, ElementsAre(scan[1], scan[3]));
}

TEST(RegionTest, AnImageGivesTheBitsOfItsPoints) {
  Random random(4);
  DepthImage image{.depth = {}, .camera = {67, 41, 61.5, 62.5, 33.2, 20.7}, .unit_m = 0.001};
  for (int i = 0; i < 67 * 41; ++i) {
    image.depth.push_back(static_cast<std::uint16_t>(i % 7 == 0 ? 0 : 300 + random() % 900));
  }
  const Points points = PointsOf(image);
  const Pose pose = RandomPose(random, 0.5);
  const Box box{{-0.4, -0.3, -0.2}, {0.5, 0.6, 0.7}};
  for (const std::optional<Box>& region : {std::optional<Box>(box), std::optional<Box>()}) {
    const RegionPoints of_image = CropImage(image, pose, region);
    const RegionPoints of_points = CropToRegion(points, pose, region);
    EXPECT_EQ(of_image.points, of_points.points);
    EXPECT_EQ(of_image.indices, of_points.indices);
    EXPECT_GT(of_image.indices.size(), 100U);
  }
}

TEST(RegionTest, FacesOfTheBoxBelongToIt) {
  const Box box{{-1, -1, 0.5}, {1, 1, 2}};
  const Points scan = {{-1, 0, 1}, {1, 1, 2},         {0, 0, 0.5F},
                       {0, 0, 2},  {1.0001F, 0, 1},   {0, -1.0001F, 1},
                       {0, 0, 3},  {0, 0, 0.499999F}, {-1, -1, 0.5F}};
  EXPECT_THAT(CropToRegion(scan, Pose::Identity(), box).indices, ElementsAre(0, 1, 2, 3, 8));
}

TEST(RegionTest, BoxIsTestedInTheTargetFrame) {
  // The sensor at (0, 0, 1) looks straight down, its x axis along the world's.
  Pose world_sensor = Pose::Identity();
  world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
  world_sensor.translation() = Eigen::Vector3d(0, 0, 1);
  const Points scan = {{0.25F, 0.5F, 0.75F}, {0.25F, -0.5F, 0.75F}};
  const Box left{{0, -1, 0}, {1, 0, 1}};
  const RegionPoints cropped = CropToRegion(scan, world_sensor, left);
  ASSERT_THAT(cropped.indices, ElementsAre(0));
  EXPECT_EQ(cropped.points[0], Eigen::Vector3f(0.25F, -0.5F, 0.25F));
}

TEST(RegionTest, ZeroIsDroppedInTheSensorFrameAndNotInTheWorldFrame) {
  Pose world_sensor = Pose::Identity();
  world_sensor.translation() = Eigen::Vector3d(0, 0, 1);
  const Points scan = {{0, 0, 0}, {0, 0, -1}};  // the second is the world's origin
  EXPECT_THAT(CropToRegion(scan, world_sensor, std::nullopt).indices, ElementsAre(1));
}

TEST(RegionTest, PointsBeyondTheSensorRangeAreNoMeasurement) {
  const Points scan = {{0, 0, 99}, {0, 0, 101}, {1e30F, 0, 0}, {0, -3e38F, 0}};
  EXPECT_THAT(CropToRegion(scan, Pose::Identity(), std::nullopt).indices, ElementsAre(0));
}

TEST(RegionTest, EmptyScanAndEmptyBoxGiveNothing) {
  EXPECT_THAT(CropToRegion({}, Pose::Identity(), std::nullopt).points, IsEmpty());
  const Box inverted{{1, 1, 1}, {-1, -1, -1}};
  EXPECT_THAT(CropToRegion({{0.5F, 0.5F, 0.5F}}, Pose::Identity(), inverted).points, IsEmpty());
}

}  // namespace
}  // namespace graspdb::recognition
