// Depths from the first Kinect's raw numbers.
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"

#include <gmock/gmock.h>

#include <cmath>

namespace graspdb::client {
namespace {

double Metres(std::uint16_t count) { return count * kKinectV1DepthUnitM; }

// By hand: at 200.375 sensor pixels of disparity, raw 801.5, lies the reference plane; a raw step
// there is a quarter of 1.042 mm, which 75 mm of baseline make 1.2 * 0.2605 / 75 = 4.17 mm.
TEST(KinectV1Calibration, TheReferencePlaneHasItsDepth) {
  const auto depths = DepthOfRaw({});
  EXPECT_NEAR((Metres(depths[801]) + Metres(depths[802])) / 2, 1.2, 1e-4);
  EXPECT_NEAR(Metres(depths[802]) - Metres(depths[801]), 0.00417, 1.5e-4);
  EXPECT_EQ(depths[kKinectV1NoRaw], 0);
}

TEST(KinectV1Calibration, DepthIncreasesWithTheRawNumberUpToTheRange) {
  const auto depths = DepthOfRaw({});
  std::size_t raw = 1;
  while (raw < depths.size() && depths[raw] > depths[raw - 1]) ++raw;
  EXPECT_GT(Metres(depths[raw - 1]), 6.0);
  for (; raw < depths.size(); ++raw) EXPECT_EQ(depths[raw], 0) << raw;
}

TEST(KinectV1Calibration, RawAndDepthAreInverse) {
  const auto depths = DepthOfRaw({});
  for (std::uint16_t raw = 0; depths[raw] != 0; ++raw) {
    // Far away a step is larger than the rounding of the depth.
    EXPECT_EQ(RawOfDepth({}, Metres(depths[raw])), raw);
  }
}

TEST(KinectV1Calibration, DepthsOutOfRangeHaveNoRawNumber) {
  EXPECT_EQ(RawOfDepth({}, 0), kKinectV1NoRaw);
  EXPECT_EQ(RawOfDepth({}, -1), kKinectV1NoRaw);
  EXPECT_EQ(RawOfDepth({}, NAN), kKinectV1NoRaw);
  EXPECT_EQ(RawOfDepth({}, 0.1), kKinectV1NoRaw);  // nearer than the largest disparity
}

TEST(KinectV1Calibration, TheFocalLengthFollowsFromTheReferencePlane) {
  const recognition::CameraIntrinsics camera = KinectV1Intrinsics({});
  EXPECT_NEAR(camera.fx, 575.8, 0.1);
  EXPECT_EQ(camera.fx, camera.fy);
  EXPECT_EQ(camera.cx, 319.5);
  // By similar triangles: a pixel of the image is two of the sensor.
  const KinectV1Calibration calibration;
  EXPECT_NEAR(1 / camera.fx * calibration.reference_distance_m, 2 * calibration.reference_pixel_m,
              1e-12);
}

TEST(KinectV1Calibration, TheDepthsDependOnTheCalibration) {
  KinectV1Calibration other;
  other.const_shift = 202;
  EXPECT_NEAR(Metres(DepthOfRaw(other)[809]), Metres(DepthOfRaw({})[801]), 1e-4);
  other.baseline_m = 0.08;
  EXPECT_LT(DepthOfRaw(other)[1000], DepthOfRaw({})[1000]);
}

}  // namespace
}  // namespace graspdb::client
