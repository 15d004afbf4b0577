// Segmentation of real Kinect scenes against their labels.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
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

using ::graspdb::testing::BestOverlap;
using ::graspdb::testing::PcdCloud;
using ::graspdb::testing::ReadPcd;
using ::graspdb::testing::SharedData;
using ::graspdb::testing::SharedDataMissing;

constexpr double kApart = 0.02;  // m; nearer objects are no test of segmentation by distance
constexpr std::uint32_t kFirstObjectLabel = 20;
// Of any one object: two of them are seen in two parts because another hides the middle.
constexpr double kMinOverlap = 0.4;

// The points of each object: labels 20 to 29 are the first, 30 to 39 the second, ...
std::map<std::uint32_t, std::set<std::int32_t>> LabelledObjects(const PcdCloud& file) {
  std::map<std::uint32_t, std::set<std::int32_t>> out;
  for (std::size_t i = 0; i < file.labels.size(); ++i) {
    if (file.labels[i] < kFirstObjectLabel || !IsMeasurement(file.cloud.points[i])) continue;
    out[file.labels[i] / 10].insert(static_cast<std::int32_t>(i));
  }
  return out;
}

bool ComeNear(const Points& points, const std::set<std::int32_t>& a,
              const std::set<std::int32_t>& b) {
  Points of_a;
  for (const std::int32_t i : a) of_a.push_back(points[static_cast<std::size_t>(i)]);
  const PointSearch search(of_a);
  for (const std::int32_t i : b) {
    const Neighbor n = search.Nearest(points[static_cast<std::size_t>(i)]);
    if (n.squared_distance < kApart * kApart) return true;
  }
  return false;
}

TEST(MosdSegmentationTest, ObjectsThatStandApartAreFound) {
  const auto folder = SharedData("mosd_tabletop");
  if (!folder) GTEST_SKIP() << SharedDataMissing("mosd_tabletop");
  int frames = 0;
  int objects = 0;
  double sum = 0;
  for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
    if (entry.path().extension() != ".pcd") continue;
    const PcdCloud file = ReadPcd(entry.path());
    Scan scan;
    scan.points = file.cloud.points;
    StageLog log;
    const auto found = SegmentScan(
        scan, {}, {}, [] { return false; }, &log);
    ASSERT_TRUE(found.ok()) << entry.path() << found.status();
    ++frames;
    const auto labelled = LabelledObjects(file);
    for (const auto& [label, points] : labelled) {
      bool apart = true;
      for (const auto& [other_label, other] : labelled) {
        apart = apart && (other_label == label || !ComeNear(scan.points, other, points));
      }
      if (!apart) continue;
      const double overlap = BestOverlap(found->segments, points);
      EXPECT_GT(overlap, kMinOverlap) << entry.path() << " object " << label;
      sum += overlap;
      ++objects;
    }
  }
  EXPECT_EQ(frames, 12);
  ASSERT_GE(objects, 12);
  RecordProperty("objects", objects);
  RecordProperty("mean_overlap", std::to_string(sum / objects));
  EXPECT_GE(sum / objects, 0.85);
}

}  // namespace
}  // namespace graspdb::recognition
