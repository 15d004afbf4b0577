#include "recognition/segmentation/segment_part.h"

#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

class PartOfTest : public ::testing::Test {
 protected:
  PartOfTest() {
    for (int i = 0; i < 100'000; ++i) {
      scan_.points.emplace_back(static_cast<float>(i), 0.0F, 0.0F);
      whole_.indices.push_back(i);
    }
    whole_.cloud.points = scan_.points;
    whole_.cloud.normals.assign(scan_.points.size(), Eigen::Vector3f::UnitZ());
  }

  Scan scan_;
  Segmentation seen_;
  Segment whole_;
};

TEST_F(PartOfTest, HasItsVoxelsAndItsPointsOfTheScan) {
  const IsPartOf is_part = [](const Eigen::Vector3f& p) {
    return static_cast<int>(p.x()) % 3 == 1;
  };
  const Segment part = PartOf(scan_, seen_, whole_, is_part);
  EXPECT_EQ(part.cloud.points.size(), 33'333U);
  EXPECT_EQ(part.cloud.normals.size(), 33'333U);
  EXPECT_EQ(part.indices.size(), 33'333U);
  EXPECT_EQ(part.indices.front(), 1);
}

TEST_F(PartOfTest, StopsWhenCancelled) {
  int looked = 0;
  const IsPartOf is_part = [&](const Eigen::Vector3f&) { return ++looked > 0; };
  PartOf(scan_, seen_, whole_, is_part, [&] { return looked > 0; });
  EXPECT_LT(looked, 20'000);
}

}  // namespace
}  // namespace graspdb::recognition
