#include <gmock/gmock.h>

#include <algorithm>
#include <set>

#include "client/cell/calibration/target/gripped_target.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3f;

// An upward plate of `count` points, 12 mm apart.
recognition::SurfaceModel Plate(int count) {
  recognition::OrientedCloud cloud;
  for (int i = 0; i < count; ++i) {
    const int row = i / 7;
    cloud.points.emplace_back(0.012F * static_cast<float>(i % 7), 0.012F * static_cast<float>(row),
                              0.0F);
    cloud.normals.emplace_back(Vector3f::UnitZ());
  }
  return {std::move(cloud), 1};
}

TEST(SidesOf, ASideHasNoDuplicatePoints) {
  std::set<std::size_t> counts;
  for (int size = 20; size <= 80; ++size) {
    for (const Side& side : SidesOf(Plate(size))) {
      counts.insert(side.points.size());
      for (std::size_t i = 0; i < side.points.size(); ++i) {
        ASSERT_EQ(std::ranges::count(side.points, side.points[i]), 1)
            << "of " << side.points.size() << " points of " << size;
      }
      ASSERT_EQ(side.anchors.size(), std::min<std::size_t>(4, side.points.size()));
    }
  }
  EXPECT_TRUE(counts.contains(37)) << "unexpected view of the plate";
  EXPECT_TRUE(counts.contains(60));
}

}  // namespace
}  // namespace graspdb::client
