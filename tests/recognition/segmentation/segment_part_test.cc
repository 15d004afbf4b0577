#include "recognition/segmentation/segment_part.h"

#include <gtest/gtest.h>

namespace graspdb::recognition {
namespace {

class PartsOfTest : public ::testing::Test {
 protected:
  PartsOfTest() {
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

TEST_F(PartsOfTest, EachPartHasItsVoxelsAndItsPointsOfTheScan) {
  const PartNumber number = [](const Eigen::Vector3f& p) {
    const int place = static_cast<int>(p.x()) % 3;
    return place == 2 ? -1 : place;
  };
  const auto parts = PartsOf(scan_, seen_, whole_, 2, number);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].cloud.points.size(), 33'334U);
  EXPECT_EQ(parts[0].indices.size(), 33'334U);
  EXPECT_EQ(parts[1].cloud.normals.size(), 33'333U);
  EXPECT_EQ(parts[1].indices.front(), 1);
}

TEST_F(PartsOfTest, StopsWhenCancelled) {
  int looked = 0;
  const IsPartOf is_part = [&](const Eigen::Vector3f&) { return ++looked > 0; };
  PartOf(scan_, seen_, whole_, is_part, [&] { return looked > 0; });
  EXPECT_LT(looked, 20'000);
}

}  // namespace
}  // namespace graspdb::recognition
