#include "client/cell/sensors/kinect/kinect_v1_calibration.h"

#include <cmath>
#include <limits>

namespace graspdb::client {
namespace {

constexpr double kStepsPerPixel = 4;    // raw steps in a pixel of the sensor
constexpr double kSensorPerImage = 2;   // pixels of the sensor in one of the image
constexpr double kShiftOffset = 0.375;  // of the centre of a window from its first pixel

}  // namespace

std::array<std::uint16_t, kKinectV1RawValues> DepthOfRaw(const KinectV1Calibration& c) {
  std::array<std::uint16_t, kKinectV1RawValues> table = {};
  for (std::size_t raw = 0; raw < kKinectV1NoRaw; ++raw) {
    const double disparity =
        static_cast<double>(raw) / kStepsPerPixel - c.const_shift - kShiftOffset;
    const double moved_m = disparity * c.reference_pixel_m;
    if (moved_m >= c.baseline_m) break;  // beyond infinity, like all that follow
    const double depth_m = c.reference_distance_m * c.baseline_m / (c.baseline_m - moved_m);
    const double counts = std::round(depth_m / kKinectV1DepthUnitM);
    if (counts > std::numeric_limits<std::uint16_t>::max()) break;
    table[raw] = static_cast<std::uint16_t>(counts);
  }
  return table;
}

std::uint16_t RawOfDepth(const KinectV1Calibration& c, double depth_m) {
  if (!(depth_m > 0)) return kKinectV1NoRaw;
  const double moved_m = c.baseline_m - c.reference_distance_m * c.baseline_m / depth_m;
  const double disparity = moved_m / c.reference_pixel_m;
  const double raw = std::round((disparity + c.const_shift + kShiftOffset) * kStepsPerPixel);
  if (raw < 0 || raw >= kKinectV1NoRaw) return kKinectV1NoRaw;
  return static_cast<std::uint16_t>(raw);
}

recognition::CameraIntrinsics KinectV1Intrinsics(const KinectV1Calibration& c) {
  const double focal = c.reference_distance_m / c.reference_pixel_m / kSensorPerImage;
  return {.width = kKinectV1Width,
          .height = kKinectV1Height,
          .fx = focal,
          .fy = focal,
          .cx = (kKinectV1Width - 1) / 2.0,
          .cy = (kKinectV1Height - 1) / 2.0};
}

rendering::DepthCameraModel SimulatedKinectV1() {
  rendering::DepthCameraModel model = rendering::KinectV1();
  model.intrinsics = KinectV1Intrinsics({});
  model.noise.disparity_steps_m = 0;
  return model;
}

}  // namespace graspdb::client
