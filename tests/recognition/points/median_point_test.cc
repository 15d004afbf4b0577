#include "recognition/points/median_point.h"

#include <gmock/gmock.h>

#include <limits>

namespace graspdb::recognition {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

Scan ScanOf(Points points) {
  Scan scan;
  scan.points = std::move(points);
  return scan;
}

TEST(MedianPoint, IsOfTheMeasuredPointsAlone) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(MedianPoint(ScanOf({{nan, nan, nan}, {0, 0, 0}})));
  EXPECT_FALSE(MedianPoint({}));
  EXPECT_EQ(*MedianPoint(ScanOf({{0, 0, 0}, {1, 2, 3}, {nan, 0, 1}})), Eigen::Vector3f(1, 2, 3));
  EXPECT_EQ(*MedianPoint(ScanOf({{1, 30, 3}, {2, 20, 100}, {3, 10, 2}})),
            Eigen::Vector3f(2, 20, 3));
}

TEST(MedianPoint, OneMeasurementAmongManyPixelsIsFound) {
  Scan scan;
  scan.depth_image = {.depth = std::vector<std::uint16_t>(100'000),
                      .camera = {1000, 100, 500, 500, 500, 50}};
  scan.depth_image.depth[77'777] = 800;
  EXPECT_FLOAT_EQ(MedianPoint(scan)->z(), 0.8F);
}

TEST(MedianPoint, WhereItIsNamesWhatIsUnusual) {
  EXPECT_THAT(WhereMedianIs({0, 0, 0.65F}, std::nullopt),
              AllOf(HasSubstr("0.65 m in front of"), Not(HasSubstr("?"))));
  EXPECT_THAT(WhereMedianIs({0, 0, 3.3F}, std::nullopt),
              AllOf(HasSubstr("3.3 m in front of"), HasSubstr("depthUnitM")));
  EXPECT_THAT(WhereMedianIs({0, 0, 0.066F}, std::nullopt), HasSubstr("is the unit right?"));
  EXPECT_THAT(WhereMedianIs({0, 0, -0.65F}, std::nullopt),
              AllOf(HasSubstr("0.65 m behind"), HasSubstr("OpenGL")));
  EXPECT_THAT(WhereMedianIs({0, 0, 0.65F}, Pose(Eigen::Translation3d(1, 0, 2))),
              HasSubstr("(1.00, 0.00, 2.65) m in the world frame"));
}

}  // namespace
}  // namespace graspdb::recognition
