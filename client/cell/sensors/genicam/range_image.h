// Range images of GenICam cameras, independent of the library that transports them.
//
// Features and chapters are those of the GenICam Standard Features Naming Convention (SFNC) 2.7.1;
// pixel formats those of the GenICam Pixel Format Naming Convention (PFNC).
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "absl/status/statusor.h"
#include "files/messages/scan_message.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// PFNC values of the pixel formats that can be read.
enum class RangeFormat : std::uint32_t {
  kC16 = 0x011000B8,     // Coord3D_C16
  kC32f = 0x012000BF,    // Coord3D_C32f
  kAbc16 = 0x023000B9,   // Coord3D_ABC16
  kAbc32f = 0x026000C0,  // Coord3D_ABC32f
};

// nullopt for another pixel format.
std::optional<RangeFormat> RangeFormatOf(std::uint32_t pixel_format);

// One axis, Scan3dCoordinateSelector (SFNC 21.4.9): value * scale + offset in the distance unit.
struct RangeAxis {
  std::optional<double> scale;  // Scan3dCoordinateScale, 21.4.10
  double offset = 0;            // Scan3dCoordinateOffset, 21.4.11
  std::optional<double>
      invalid;  // Scan3dInvalidDataValue, 21.4.13, if Scan3dInvalidDataFlag, 21.4.12
};

// What the features of a camera say about its values.
struct RangeGeometry {
  std::string output_mode;        // Scan3dOutputMode, 21.4.7; empty: the camera has none
  std::string coordinate_system;  // Scan3dCoordinateSystem, 21.4.6; empty: Cartesian
  std::string distance_unit;      // Scan3dDistanceUnit, 21.4.5; empty: Millimeter
  std::array<RangeAxis, 3> axes;  // CoordinateA, B and C: x, y, z
  double focal_length = 0;        // Scan3dFocalLength, 21.4.20, pixels; 0: the camera has none
  double aspect_ratio = 1;        // Scan3dAspectRatio, of some vendors: fy / fx
  double principal_u = 0;         // Scan3dPrincipalPointU, 21.4.22, pixels
  double principal_v = 0;         // Scan3dPrincipalPointV, 21.4.23
  double baseline_m = 0;          // Scan3dBaseline, 21.4.21; 0: the camera has none
};

// One image as the camera sent it, little-endian, row by row without padding.
struct RangeImage {
  RangeFormat format = RangeFormat::kC16;
  int width = 0;
  int height = 0;
  std::span<const char> data = {};
};

// The scan of an image: of C formats a depth image, with `intrinsics` if given and else by focal
// length and principal point; of ABC formats an organised cloud, with NaN where there is no
// measurement. Counts of C16 without an offset are kept as they are.
//
// Output modes: UncalibratedC, RectifiedC and those of line scans have no image of a pinhole camera
// and are refused, as are coordinate systems that are not Cartesian. DisparityC needs focal length
// and baseline: depth = focal length * baseline / disparity.
//
// FAILED_PRECONDITION for settings of the camera that are missing or cannot be read, with the
// feature; DATA_LOSS for an image of another size. Allocates by the size of `data` only.
absl::StatusOr<files::ScanMessage> ScanOfRange(
    const RangeImage& image, const RangeGeometry& geometry,
    const std::optional<recognition::CameraIntrinsics>& intrinsics);

}  // namespace graspdb::client
