// Scans without a segment, and the reasons.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "recognition/segmentation/region.h"
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
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class SegmentationFailureTest : public ::testing::Test {
 protected:
  SegmentationFailureTest() {
    scan_.world_sensor = LookAt({0, -0.4, 0.5}, {0, 0, 0});
    scan_.points = TakePicture({}, *scan_.world_sensor, SmallCamera()).points;
  }

  absl::StatusOr<Segmentation> Run() {
    log_ = StageLog();
    return SegmentScan(
        scan_, parameters_, {}, [] { return false; }, &log_);
  }

  // Runs with a caller that cancels once the log has so many steps.
  absl::StatusOr<Segmentation> RunSteps(std::size_t count) {
    log_ = StageLog();
    return SegmentScan(
        scan_, parameters_, {}, [&] { return log_.reports().size() >= count; }, &log_);
  }

  std::vector<std::string> Stages() const {
    std::vector<std::string> out;
    for (const StageReport& report : log_.reports()) out.push_back(report.stage);
    return out;
  }

  void ExpectNoSegment(SegmentationOutcome outcome) {
    const auto found = Run();
    ASSERT_THAT(found, IsOk());
    EXPECT_EQ(found->outcome, outcome);
    EXPECT_THAT(found->segments, IsEmpty());
  }

  Scan scan_;
  SegmentationParameters parameters_;
  StageLog log_;
};

TEST_F(SegmentationFailureTest, BareTableHasNoCluster) {
  ExpectNoSegment(SegmentationOutcome::kNoCluster);
  scan_.world_sensor.reset();
  ExpectNoSegment(SegmentationOutcome::kNoCluster);
}

TEST_F(SegmentationFailureTest, RegionBesideEverythingIsEmpty) {
  scan_.region = Box{{5, 5, 5}, {6, 6, 6}};
  ExpectNoSegment(SegmentationOutcome::kEmptyRegion);
}

TEST_F(SegmentationFailureTest, ScanWithoutMeasurementsIsAnEmptyRegion) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  scan_.points.assign(5000, {nan, nan, nan});
  for (const bool known_pose : {true, false}) {
    if (!known_pose) scan_.world_sensor.reset();
    for (const bool segmented : {false, true}) {
      scan_.segmented = segmented;
      ExpectNoSegment(SegmentationOutcome::kEmptyRegion);
    }
  }
  scan_.points.clear();
  ExpectNoSegment(SegmentationOutcome::kEmptyRegion);
}

TEST_F(SegmentationFailureTest, DirtIsNoCluster) {
  Random random(61);
  scan_.points = RandomPoints(random, 60, 0.4);
  for (auto& p : scan_.points) p.z() += 0.6F;
  ExpectNoSegment(SegmentationOutcome::kNoCluster);
}

TEST_F(SegmentationFailureTest, SegmentedScanWithTooFewVoxelsIsNoCluster) {
  scan_.segmented = true;
  Random random(62);
  scan_.points = RandomPoints(random, 49, 0.1);
  for (auto& p : scan_.points) p.z() += 0.6F;
  ExpectNoSegment(SegmentationOutcome::kNoCluster);
  parameters_.min_cluster_point_count = 20;
  EXPECT_THAT(Run()->segments, SizeIs(1));
}

TEST_F(SegmentationFailureTest, ClusterHasTenVoxelsAtLeastWhateverIsConfigured) {
  scan_.segmented = true;
  scan_.points.assign(9, Eigen::Vector3f::Zero());
  for (int i = 0; i < 9; ++i) {
    scan_.points[static_cast<std::size_t>(i)] = {0.01F * static_cast<float>(i), 0.0F, 0.5F};
  }
  parameters_.min_cluster_point_count = 1;
  ExpectNoSegment(SegmentationOutcome::kNoCluster);
}

// A dense ball in the air: no plane contains a tenth of its points.
Points Ball() {
  Random random(63);
  Points out;
  for (const auto& p : RandomPoints(random, 20000, 0.16)) {
    if (p.norm() < 0.08F && p.norm() > 0.075F) out.push_back(p + Eigen::Vector3f(0, 0, 0.6F));
  }
  return out;
}

TEST_F(SegmentationFailureTest, WithoutAPlaneNothingIsRemovedWhenThePoseIsKnown) {
  scan_.points = Ball();
  const auto found = Run();
  ASSERT_THAT(found, IsOk());
  EXPECT_FALSE(found->table);
  ASSERT_THAT(found->segments, SizeIs(1));
  EXPECT_GT(found->segments[0].indices.size(), scan_.points.size() * 9 / 10);
}

TEST_F(SegmentationFailureTest, WithoutAPlaneAndAPoseTheWorldIsTheSensors) {
  scan_.points = Ball();
  scan_.world_sensor.reset();
  const auto found = Run();
  ASSERT_THAT(found, IsOk());
  EXPECT_EQ(found->world_frame, WorldFrame::kSensor);
  EXPECT_FALSE(found->HasGravity());
  EXPECT_TRUE(found->world_sensor.isApprox(Pose::Identity()));
  ASSERT_THAT(found->segments, SizeIs(1));
  EXPECT_GT(found->segments[0].indices.size(), scan_.points.size() * 9 / 10);
}

testing::Solid BoxAt(double x, double y, const Eigen::Vector3d& size) {
  testing::Solid out;
  out.world_solid.translation() = Eigen::Vector3d(x, y, 0);
  out.boxes = {{{-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()}}};
  return out;
}

// More than half of the picture is one of its faces.
TEST_F(SegmentationFailureTest, AFaceOfABoxIsNoTable) {
  const testing::Scene scene = {.solids = {BoxAt(0, 0, {0.16, 0.12, 0.1})}, .table_half_edge_m = 0};
  scan_.points = TakePicture(scene, *scan_.world_sensor, SmallCamera()).points;
  const auto measured = std::ranges::count_if(scan_.points, IsMeasurement);
  scan_.world_sensor.reset();
  const auto found = Run();
  ASSERT_THAT(found, IsOk());
  EXPECT_FALSE(found->HasGravity());
  EXPECT_FALSE(found->table);
  ASSERT_THAT(found->segments, SizeIs(1));
  EXPECT_GT(found->segments[0].indices.size(), 0.9 * static_cast<double>(measured));
}

// A table that is too black to be measured: the lowest 12 mm of the objects are in a plane as well.
TEST_F(SegmentationFailureTest, TheFeetOfObjectsAreNoTable) {
  testing::Scene scene = {.solids = {}, .table_half_edge_m = 0};
  for (const double x : {-0.12, 0.0, 0.12}) scene.solids.push_back(BoxAt(x, 0, {0.05, 0.03, 0.06}));
  const auto picture = TakePicture(scene, *scan_.world_sensor, SmallCamera());
  scan_.points = picture.points;
  const auto found = Run();
  ASSERT_THAT(found, IsOk());
  EXPECT_FALSE(found->table);
  ASSERT_THAT(found->segments, SizeIs(3));
  for (const Segment& segment : found->segments) {
    const auto shown = picture.shown[static_cast<std::size_t>(segment.indices.front())];
    EXPECT_GT(segment.indices.size(),
              0.9 * static_cast<double>(std::ranges::count(picture.shown, shown)));
  }
}

TEST_F(SegmentationFailureTest, ARegionNeedsATableOrAPose) {
  scan_.points = Ball();
  scan_.region = Box{{-0.2, -0.2, 0}, {0.2, 0.2, 0.3}};
  scan_.world_sensor.reset();
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("sensor pose")));
}

TEST_F(SegmentationFailureTest, WhatIsBeyondReachGivesNoWorldFrame) {
  scan_.world_sensor.reset();
  for (auto& p : scan_.points) p *= 4;
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("1.5 m")));
}

TEST_F(SegmentationFailureTest, CancellationIsPolledBetweenTheSteps) {
  EXPECT_THAT(RunSteps(1), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(Stages(), ElementsAre("region"));
  EXPECT_THAT(RunSteps(2), StatusIs(absl::StatusCode::kCancelled));
  EXPECT_THAT(Stages(), ElementsAre("region", "plane"));
  EXPECT_THAT(RunSteps(1000), IsOk());
}

TEST_F(SegmentationFailureTest, StagesReportThePointsOfEachStep) {
  ASSERT_THAT(Run(), IsOk());
  EXPECT_THAT(Stages(), ElementsAre("region", "plane", "outliers", "voxels", "clusters"));
  const std::vector<StageReport>& reports = log_.reports();
  EXPECT_EQ(reports[0].input_points, scan_.points.size());
  for (std::size_t i = 1; i < reports.size(); ++i) {
    EXPECT_EQ(reports[i].input_points, reports[i - 1].output_points) << reports[i].stage;
  }
  EXPECT_EQ(reports[1].output_points, 0U);
}

}  // namespace
}  // namespace graspdb::recognition
