// From a depth image of boxes on a table to one segment a box.
#include "recognition/segmentation/segmentation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "recognition/segmentation/region.h"
#include "tests/recognition/scenes/table_scene.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::LookAt;
using ::graspdb::testing::Picture;
using ::graspdb::testing::Scene;
using ::graspdb::testing::SmallCamera;
using ::graspdb::testing::Solid;
using ::graspdb::testing::TakePicture;
using ::testing::SizeIs;

constexpr int kFar = 0;
constexpr int kNear = 1;

Solid BoxOnTable(double x, double y, const Vector3d& size) {
  Solid out;
  out.world_solid.translation() = Vector3d(x, y, 0);
  out.boxes = {{{-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()}}};
  return out;
}

class TwoBoxesTest : public ::testing::Test {
 protected:
  TwoBoxesTest() {
    scene_.solids = {BoxOnTable(-0.07, 0.08, {0.06, 0.06, 0.10}),
                     BoxOnTable(0.06, -0.05, {0.08, 0.05, 0.06})};
    picture_ = TakePicture(scene_, world_sensor_, SmallCamera());
    scan_.points = picture_.points;
    scan_.world_sensor = world_sensor_;
  }

  Segmentation Must() {
    StageLog log;
    const auto found = SegmentScan(
        scan_, {}, {}, [] { return false; }, &log);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or(Segmentation());
  }

  // Share of the segment's points that show the solid, and of the solid's that it has.
  void ExpectShows(const Segment& segment, int solid) const {
    const auto shows = [&](std::int32_t i) {
      return picture_.shown[static_cast<std::size_t>(i)] == solid;
    };
    EXPECT_TRUE(std::ranges::all_of(segment.indices, shows)) << "solid " << solid;
    const auto all = std::ranges::count(picture_.shown, solid);
    EXPECT_GT(segment.indices.size(), 0.85 * static_cast<double>(all)) << "solid " << solid;
    EXPECT_TRUE(std::ranges::is_sorted(segment.indices));
  }

  const Pose world_sensor_ = LookAt({0.05, -0.45, 0.45}, {0, 0, 0.03});
  Scene scene_;
  Picture picture_;
  Scan scan_;
};

TEST_F(TwoBoxesTest, TableIsRemovedAndEachBoxIsASegmentTheNearestFirst) {
  const Segmentation found = Must();
  EXPECT_EQ(found.outcome, SegmentationOutcome::kFound);
  EXPECT_EQ(found.world_frame, WorldFrame::kGiven);
  ASSERT_THAT(found.segments, SizeIs(2));
  ExpectShows(found.segments[0], kNear);
  ExpectShows(found.segments[1], kFar);
  ASSERT_TRUE(found.table);
  EXPECT_GT(found.table->normal.z(), 1 - 1e-6);
  EXPECT_NEAR(found.table->offset, 0, 1e-4);
  EXPECT_EQ(found.table_reach_m, SegmentationParameters().plane_distance_m);
}

TEST_F(TwoBoxesTest, SegmentsLieInTheWorldFrameWithNormalsTowardsTheSensor) {
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(2));
  const Vector3d eye = world_sensor_.translation();
  for (const Segment& segment : found.segments) {
    ASSERT_EQ(segment.cloud.points.size(), segment.cloud.normals.size());
    EXPECT_TRUE(segment.centroid.isApprox(Centroid(segment.cloud.points), 1e-12));
    for (std::size_t i = 0; i < segment.cloud.points.size(); ++i) {
      const Vector3d p = segment.cloud.points[i].cast<double>();
      EXPECT_GE(segment.cloud.normals[i].cast<double>().dot(eye - p), -1e-6);
      EXPECT_GT(p.z(), 0.005);
    }
  }
  // Within the near box, grown by a hair.
  const Box near_box{{0.0199, -0.0751, 0}, {0.1001, -0.0249, 0.0601}};
  for (const auto& p : found.segments[0].cloud.points) {
    EXPECT_TRUE(near_box.Contains(p.cast<double>())) << p.transpose();
  }
}

TEST_F(TwoBoxesTest, UnknownSensorPoseGivesTheSameSegmentsOnATableAtZero) {
  const Segmentation given = Must();
  scan_.world_sensor.reset();
  const Segmentation found = Must();
  EXPECT_EQ(found.world_frame, WorldFrame::kDominantPlane);
  ASSERT_THAT(found.segments, SizeIs(2));
  ExpectShows(found.segments[0], kNear);
  ExpectShows(found.segments[1], kFar);
  EXPECT_NEAR(found.world_sensor.translation().z(), world_sensor_.translation().z(), 1e-3);
  const Vector3d up =
      found.world_sensor.linear() * world_sensor_.linear().transpose() * Vector3d::UnitZ();
  EXPECT_GT(up.z(), std::cos(0.002));
  ASSERT_TRUE(found.table);
  EXPECT_NEAR(found.table->offset, 0, 1e-4);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(found.segments[i].centroid.z(), given.segments[i].centroid.z(), 2e-3);
  }
}

TEST_F(TwoBoxesTest, PointsOutsideTheRegionAreLeftOut) {
  scan_.region = Box{{-0.2, 0, -0.05}, {0.2, 0.3, 0.3}};
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(1));
  ExpectShows(found.segments[0], kFar);
}

TEST_F(TwoBoxesTest, MissingDepthDoesNotShiftTheIndices) {
  for (std::size_t i = 0; i < scan_.points.size(); i += 7) {
    if (i % 2 == 0) {
      scan_.points[i].setZero();
    } else {
      scan_.points[i].setConstant(std::numeric_limits<float>::quiet_NaN());
    }
    picture_.shown[i] = ::graspdb::testing::kNothing;
  }
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(2));
  ExpectShows(found.segments[0], kNear);
  ExpectShows(found.segments[1], kFar);
}

TEST_F(TwoBoxesTest, SameScanGivesTheSameBits) {
  const Segmentation first = Must();
  const Segmentation again = Must();
  ASSERT_EQ(first.segments.size(), again.segments.size());
  for (std::size_t i = 0; i < first.segments.size(); ++i) {
    EXPECT_EQ(first.segments[i].indices, again.segments[i].indices);
    EXPECT_EQ(first.segments[i].cloud.points, again.segments[i].cloud.points);
    EXPECT_EQ(first.segments[i].cloud.normals, again.segments[i].cloud.normals);
  }
}

// A flap in the air behind a box, on a rod that the box hides.
TEST_F(TwoBoxesTest, PartOnAHiddenSupportJoinsItsNeighbour) {
  Solid handle = BoxOnTable(0, 0, {0.06, 0.06, 0.05});
  handle.boxes.push_back({{-0.03, 0.05, 0.05}, {0.03, 0.09, 0.055}});  // 2 cm behind, in the air
  handle.boxes.push_back({{-0.002, -0.001, 0.01}, {0.002, 0.06, 0.0101}});
  scene_.solids = {handle};
  picture_ = TakePicture(scene_, world_sensor_, SmallCamera());
  scan_.points = picture_.points;
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(1));
  ExpectShows(found.segments[0], 0);
}

TEST_F(TwoBoxesTest, SegmentedScanIsOneSegmentWhateverItContains) {
  scan_.segmented = true;
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(1));
  EXPECT_FALSE(found.table);
  EXPECT_EQ(found.table_reach_m, 0);
  const auto finite =
      std::ranges::count_if(scan_.points, [](const auto& p) { return p.allFinite(); });
  EXPECT_THAT(found.segments[0].indices, SizeIs(static_cast<std::size_t>(finite)));
}

TEST_F(TwoBoxesTest, SegmentedScanWithoutAPoseStaysInTheSensorFrame) {
  for (std::size_t i = 0; i < scan_.points.size(); ++i) {
    if (picture_.shown[i] != kNear) scan_.points[i].setZero();
  }
  scan_.segmented = true;
  scan_.world_sensor.reset();
  const Segmentation found = Must();
  ASSERT_THAT(found.segments, SizeIs(1));
  EXPECT_EQ(found.world_frame, WorldFrame::kSensor);
  EXPECT_EQ(found.world_sensor.matrix(), Pose::Identity().matrix());
  EXPECT_NEAR(found.segments[0].centroid.z(), 0.58, 0.05);
}

TEST(DefaultRegionTest, ReachesFromTheWorldsOriginToTheFootOfTheSensor) {
  Pose sensor = Pose::Identity();
  sensor.translation() = Vector3d(0.2, -0.9, 0.7);
  const Box region = DefaultRegion(sensor);
  EXPECT_TRUE(region.Contains({0.5, 0.5, 0.6}));
  EXPECT_TRUE(region.Contains({0, -0.9, -0.05}));
  EXPECT_FALSE(region.Contains({0, 0.51, 0}));
  EXPECT_FALSE(region.Contains({0, -0.91, 0}));
  EXPECT_FALSE(region.Contains({0, 0, 0.61}));
}

TEST(PrepareCloudTest, IsThinnedToVoxelsWithNormalsTowardsTheViewpoint) {
  Points points;
  for (int x = 0; x < 100; ++x) {
    for (int y = 0; y < 100; ++y) {
      points.emplace_back(0.0005F * static_cast<float>(x) + 0.0001F,
                          0.0005F * static_cast<float>(y) + 0.0001F, 0.0F);
    }
  }
  const OrientedCloud cloud = PrepareCloud(points, {0, 0, 1}, {});
  EXPECT_THAT(cloud.points, SizeIs(17 * 17));  // 5 cm in voxels of 3 mm
  for (const auto& n : cloud.normals) EXPECT_GT(n.z(), 0.9999F);
}

}  // namespace
}  // namespace graspdb::recognition
