// Segmentation of real RealSense frames against the object's points.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "recognition/points/point_search.h"
#include "recognition/segmentation/region.h"
#include "recognition/segmentation/segmentation.h"
#include "tests/recognition/scenes/pcd_file.h"
#include "tests/recognition/scenes/segment_overlap.h"
#include "tests/recognition/scenes/shared_data.h"

namespace graspdb::recognition {
namespace {

using ::graspdb::testing::Overlap;
using ::graspdb::testing::ReadPcd;
using ::graspdb::testing::SharedData;
using ::graspdb::testing::SharedDataMissing;

// The object's cloud was unprojected from a depth image of its own, with other rounding.
constexpr double kSamePoint = 1e-3;  // m

// Positions of the object's points in the frame.
std::set<std::int32_t> Locate(const Points& frame, const Points& object) {
  const PointSearch search(object);
  std::set<std::int32_t> out;
  for (std::size_t i = 0; i < frame.size(); ++i) {
    if (!IsMeasurement(frame[i])) continue;
    if (search.Nearest(frame[i]).squared_distance > kSamePoint * kSamePoint) continue;
    out.insert(static_cast<std::int32_t>(i));
  }
  return out;
}

class RealsenseSegmentationTest : public ::testing::TestWithParam<const char*> {};

TEST_P(RealsenseSegmentationTest, FirstSegmentIsTheObject) {
  const auto folder = SharedData("realsense_tabletop");
  if (!folder) GTEST_SKIP() << SharedDataMissing("realsense_tabletop");
  const std::string name = GetParam();
  Scan scan;
  scan.points = ReadPcd(*folder / (name + ".pcd")).cloud.points;
  const Points object = ReadPcd(*folder / (name + "_object.pcd")).cloud.points;
  const std::set<std::int32_t> truth = Locate(scan.points, object);
  ASSERT_GT(truth.size(), object.size() * 9 / 10) << "the object is not part of the frame";

  StageLog log;
  const auto found = SegmentScan(
      scan, {}, {}, [] { return false; }, &log);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->world_frame, WorldFrame::kDominantPlane);
  ASSERT_FALSE(found->segments.empty());
  const double overlap = Overlap(found->segments[0], truth);
  RecordProperty("overlap", std::to_string(overlap));
  EXPECT_GE(overlap, 0.85);
}

INSTANTIATE_TEST_SUITE_P(Frames, RealsenseSegmentationTest,
                         ::testing::Values("blue_mug", "cylinder", "green_bowl", "pepper",
                                           "red_mug"),
                         [](const auto& frame) { return std::string(frame.param); });

}  // namespace
}  // namespace graspdb::recognition
