// Converts the first Kinect's raw disparities to depths.
#pragma once

#include <array>
#include <cstdint>

#include "recognition/base/types.h"
#include "rendering/camera/depth_camera.h"

namespace graspdb::client {

inline constexpr int kKinectV1Width = 640;
inline constexpr int kKinectV1Height = 480;
// Raw disparities are 11 bits; the last value means no measurement.
inline constexpr int kKinectV1RawValues = 2048;
inline constexpr std::uint16_t kKinectV1NoRaw = 2047;
// Unit of depth counts: finer than a millimetre, because a disparity step is 1.2 mm at 0.65 m; the
// range exceeds the camera's.
inline constexpr double kKinectV1DepthUnitM = 0.0001;

// The triangulation of a camera and a projector beside it, by a reference plane: "zero plane" in
// libfreenect, which reads it from the device. The defaults are those of most devices.
struct KinectV1Calibration {
  double reference_distance_m = 1.2;    // of the reference plane
  double reference_pixel_m = 0.001042;  // a pixel of the sensor (1280 wide) on the reference plane
  double baseline_m = 0.075;            // from the projector to the camera
  double const_shift = 200;             // disparity of the reference plane, sensor pixels
};

// Depth of every raw disparity, in kKinectV1DepthUnitM; 0 for none, or if it does not fit.
//
// A raw step is a quarter of a sensor pixel. The disparity d against the reference plane moves a
// point by m = d * reference_pixel on that plane, and z = reference_distance * baseline /
// (baseline - m), from similar triangles, like libfreenect's conversion to millimetres, unrounded.
std::array<std::uint16_t, kKinectV1RawValues> DepthOfRaw(const KinectV1Calibration& calibration);

// The nearest raw disparity, as the camera would send it. kKinectV1NoRaw for 0 and for depths out
// of range.
std::uint16_t RawOfDepth(const KinectV1Calibration& calibration, double depth_m);

// Its pinhole model: focal length from the reference plane, the principal point in the middle, no
// distortion.
recognition::CameraIntrinsics KinectV1Intrinsics(const KinectV1Calibration& calibration);

// A simulated camera that matches the sensor: KinectV1() with the intrinsics of most devices, and
// without disparity steps, which the raw numbers already have.
rendering::DepthCameraModel SimulatedKinectV1();

}  // namespace graspdb::client
