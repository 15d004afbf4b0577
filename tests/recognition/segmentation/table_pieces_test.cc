// Parts of a table that a distorted camera shows above its plane are no objects.
#include "recognition/segmentation/table_pieces.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "tests/recognition/scenes/table_scene.h"

namespace graspdb::recognition {
namespace {

using Eigen::Vector3d;
using ::graspdb::testing::Scene;
using ::graspdb::testing::Solid;
using ::testing::SizeIs;

// Height of the table at x, m, as a camera whose image is bowed shows it: flat in the middle, then
// slopes of 5 degrees up to 10 mm.
double BowedTable(double x) { return std::clamp(0.08 * (std::abs(x) - 0.08), 0.0, 0.01); }

class TablePiecesTest : public ::testing::Test {
 protected:
  // A box of `size` at x on the table.
  void Place(double x, const Vector3d& size) {
    Solid box;
    box.world_solid.translation() = Vector3d(x, 0, 0);
    box.boxes = {{{-size.x() / 2, -size.y() / 2, 0}, {size.x() / 2, size.y() / 2, size.z()}}};
    scene_.solids.push_back(box);
  }

  // The segments where everything is higher by `rise` of its x.
  Segmentation Segments(const std::function<double(double)>& rise) {
    const Pose world_sensor = testing::LookAt({0.0, -0.35, 0.55}, {0, 0, 0});
    Scan scan;
    scan.world_sensor = world_sensor;
    scan.points = testing::TakePicture(scene_, world_sensor, testing::SmallCamera()).points;
    for (Eigen::Vector3f& p : scan.points) {
      if (!p.allFinite()) continue;
      Vector3d world = world_sensor * p.cast<double>();
      world.z() += rise(world.x());
      p = (world_sensor.inverse() * world).cast<float>();
    }
    log_ = {};
    const auto found = SegmentScan(
        scan, {}, {}, [] { return false; }, &log_);
    EXPECT_TRUE(found.ok()) << found.status();
    return found.value_or(Segmentation());
  }

  bool HasStep() const {
    const auto is_step = [](const StageReport& step) { return step.stage == "table_pieces"; };
    return std::ranges::any_of(log_.reports(), is_step);
  }

  Scene scene_;
  StageLog log_;
};

TEST_F(TablePiecesTest, APartOfTheTableThatRisesIsNoSegment) {
  Place(0, {0.05, 0.05, 0.05});
  const Segmentation found = Segments(BowedTable);
  ASSERT_THAT(found.segments, SizeIs(1));
  EXPECT_NEAR(found.segments.front().centroid.x(), 0, 0.02);
  ASSERT_TRUE(HasStep());
  const StageReport& step = log_.reports().back();
  EXPECT_EQ(step.output_points, found.segments.front().cloud.points.size());
  EXPECT_GT(step.input_points, step.output_points + 200);
}

TEST_F(TablePiecesTest, ATableWithoutObjectsHasNone) {
  const Segmentation found = Segments(BowedTable);
  EXPECT_TRUE(HasStep());
  EXPECT_THAT(found.segments, SizeIs(0));
  EXPECT_EQ(found.outcome, SegmentationOutcome::kNoCluster);
}

TEST_F(TablePiecesTest, APlateIsASegment) {
  Place(-0.1, {0.06, 0.06, 0.008});
  EXPECT_THAT(Segments([](double) { return 0; }).segments, SizeIs(1));
}

TEST_F(TablePiecesTest, AShallowDomeIsASegment) {
  // 10 mm high and 240 mm wide: its side begins where it is as high as a plate's.
  const auto dome = [](double x) { return std::max(0.0, 0.01 * (1 - x * x / (0.12 * 0.12))); };
  EXPECT_THAT(Segments(dome).segments, SizeIs(1));
  EXPECT_FALSE(HasStep());
}

TEST_F(TablePiecesTest, APlateOnATableThatHasRisenIsASegment) {
  Place(0.14, {0.06, 0.06, 0.01});
  const auto rises_by_4_mm = [](double x) { return std::min(0.004, BowedTable(x)); };
  EXPECT_THAT(Segments(rises_by_4_mm).segments, SizeIs(1));
}

}  // namespace
}  // namespace graspdb::recognition
