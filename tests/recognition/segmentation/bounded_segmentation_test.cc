// Invalid scans, which cameras do send.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/synthetic_clouds.h"
#include "tests/recognition/scenes/table_scene.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::IsOk;
using ::graspdb::testing::LookAt;
using ::graspdb::testing::Random;
using ::graspdb::testing::RandomPoints;
using ::graspdb::testing::SmallCamera;
using ::graspdb::testing::StatusIs;
using ::graspdb::testing::TakePicture;
using ::graspdb::testing::WavySurface;
using ::testing::HasSubstr;
using ::testing::SizeIs;

bool Never() { return false; }

// More points than the voxel limit, in a cube of `size_m`.
Scan ManyPoints(double size_m) {
  Random random(6);
  Scan out;
  out.points = RandomPoints(random, kMaxVoxels + 100'000, size_m);
  out.world_sensor = Pose::Identity();
  out.region = Box{Eigen::Vector3d::Constant(-5), Eigen::Vector3d::Constant(5)};
  return out;
}

class BoundedSegmentationTest : public ::testing::Test {
 protected:
  absl::StatusOr<Segmentation> Run(const Scan& scan) {
    log_ = StageLog();
    return SegmentScan(scan, parameters_, {}, Never, &log_);
  }

  // Points that the stage left out; -1 where there was no such stage.
  int LeftOut(std::string_view stage) const {
    for (const StageReport& report : log_.reports()) {
      if (report.stage == stage)
        return static_cast<int>(report.input_points) - static_cast<int>(report.output_points);
    }
    return -1;
  }

  SegmentationParameters parameters_;
  StageLog log_;
};

Scan Part(Random& random) {
  Scan out;
  out.points = WavySurface(random, 4000).points;
  for (Eigen::Vector3f& p : out.points) p.z() += 0.5F;
  out.segmented = true;
  return out;
}

TEST_F(BoundedSegmentationTest, StraysFarFromASegmentedPartAreLeftOutAndCounted) {
  Random random(1);
  Scan scan = Part(random);
  const auto clean = Run(scan);
  ASSERT_THAT(clean, IsOk());
  EXPECT_EQ(LeftOut("extent"), -1);
  scan.points.emplace_back(3, 0, 0.5F);
  scan.points.emplace_back(0, 3, 3);
  const auto found = Run(scan);
  ASSERT_THAT(found, IsOk());
  EXPECT_EQ(LeftOut("extent"), 2);
  EXPECT_EQ(found->far_point_count, 2U);
  ASSERT_THAT(found->segments, SizeIs(1));
  EXPECT_EQ(found->segments.front().cloud.points, clean->segments.front().cloud.points);
  EXPECT_FALSE(found->segments.front().too_large);
}

TEST_F(BoundedSegmentationTest, PointsBeyondTheRangeAreLeftOutAndCounted) {
  Random random(2);
  Scan scan = Part(random);
  scan.points.emplace_back(0, 0, 80);
  scan.points.emplace_back(-12, 0, 0.5F);
  ASSERT_THAT(Run(scan), IsOk());
  EXPECT_EQ(LeftOut("range"), 2);
  parameters_.max_range_m = 90;
  ASSERT_THAT(Run(scan), IsOk());
  EXPECT_EQ(LeftOut("range"), -1);
}

TEST_F(BoundedSegmentationTest, ATooLargeSegmentIsMarked) {
  Random random(3);
  Scan scan = Part(random);
  ASSERT_FALSE(Run(scan)->segments.front().too_large);
  parameters_.max_object_size_m = 0.1;
  ASSERT_TRUE(Run(scan)->segments.front().too_large);
}

TEST_F(BoundedSegmentationTest, FarStraysInAHugeRegionHideNothing) {
  Random random(4);
  Scan scan;
  scan.world_sensor = LookAt({0, -0.4, 0.5}, {0, 0, 0});
  scan.region = Box{Eigen::Vector3d::Constant(-50), Eigen::Vector3d::Constant(50)};
  testing::Solid solid;
  solid.boxes = {{{-0.05, -0.03, 0}, {0.05, 0.03, 0.06}}};
  testing::Scene scene;
  scene.solids = {solid};
  scan.points = TakePicture(scene, *scan.world_sensor, SmallCamera()).points;
  const auto clean = Run(scan);
  ASSERT_THAT(clean, IsOk());
  ASSERT_THAT(clean->segments, SizeIs(1));
  for (const double size : {8.0, 60.0}) {
    Scan with = scan;
    for (const Eigen::Vector3f& p : RandomPoints(random, 50, size)) with.points.push_back(p);
    parameters_.max_range_m = 100;
    const auto found = Run(with);
    ASSERT_THAT(found, IsOk());
    ASSERT_THAT(found->segments, SizeIs(1));
    EXPECT_LT((found->segments.front().centroid - clean->segments.front().centroid).norm(), 0.005);
  }
}

TEST_F(BoundedSegmentationTest, ManyPointsInOnePlaceAreOneVoxel) {
  Scan scan;
  scan.points.assign(2'000'000, {0.1F, 0.1F, 0.6F});
  scan.world_sensor = Pose::Identity();
  const auto found = Run(scan);
  ASSERT_THAT(found, IsOk());
  EXPECT_EQ(found->outcome, SegmentationOutcome::kNoCluster);
}

TEST_F(BoundedSegmentationTest, AScanOfTooManyVoxelsIsRejected) {
  Scan scan = ManyPoints(0.8);
  EXPECT_THAT(Run(scan), StatusIs(absl::StatusCode::kInvalidArgument));
  scan.segmented = true;
  EXPECT_THAT(Run(scan), StatusIs(absl::StatusCode::kInvalidArgument));
  // As many points in fewer voxels are accepted.
  for (Eigen::Vector3f& p : scan.points) p *= 0.03F;
  EXPECT_THAT(Run(scan), IsOk());
}

TEST_F(BoundedSegmentationTest, NoStepBeginsAfterCancellation) {
  const Scan scan = ManyPoints(0.02);
  StageLog log;
  int polls = 0;  // since the table was looked for
  const auto while_voxels_are_counted = [&] {
    const bool has_table = std::ranges::any_of(
        log.reports(), [](const StageReport& stage) { return stage.stage == "plane"; });
    return has_table && ++polls > 1;
  };
  const auto found = SegmentScan(scan, parameters_, {}, while_voxels_are_counted, &log);
  EXPECT_THAT(found, StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(found.status().message(), HasSubstr("table plane"));
}

TEST_F(BoundedSegmentationTest, CancellationIsPolledWithinEachStep) {
  Random random(5);
  Scan scan;
  scan.points = RandomPoints(random, 300'000, 0.5);
  scan.world_sensor = Pose::Identity();
  int calls = 0;
  StageLog log;
  const auto count = [&] { return ++calls, false; };
  ASSERT_THAT(SegmentScan(scan, parameters_, {}, count, &log), IsOk());
  // Far more often than between its steps.
  EXPECT_GT(calls, 50);
  for (int last = 1; last < calls; last += 1 + calls / 20) {
    int polls = 0;
    EXPECT_THAT(SegmentScan(
                    scan, parameters_, {}, [&] { return ++polls >= last; }, &log),
                StatusIs(absl::StatusCode::kCancelled));
    EXPECT_EQ(polls, last);
  }
}

}  // namespace
}  // namespace graspdb::recognition
