// Poses and cameras in the HDF5 files of a BigBIRD object.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "lab/datasets/depth_map.h"
#include "recognition/base/types.h"

namespace graspdb::client {

// In the folder of an object.
inline constexpr char kBigBirdCalibrationFile[] = "calibration.h5";
// The RGB camera that all poses are told by.
inline constexpr char kBigBirdReference[] = "NP5";

// T_table_reference with the turntable turned by `turn_deg`. The table's frame turns with it; the
// file does not say on which side of it the cameras are. Errors as ReadHdf5; INVALID_ARGUMENT when
// it is no rigid transform.
absl::StatusOr<recognition::Pose> ReadTablePose(const std::filesystem::path& object, int turn_deg);

// T_rgb_reference of the RGB camera of `camera` ("NP1" … "NP5"), and T_ir_reference of its depth
// camera. Errors as ReadTablePose.
absl::StatusOr<recognition::Pose> ReadRgbPose(const std::filesystem::path& object,
                                              const std::string& camera);
absl::StatusOr<recognition::Pose> ReadIrPose(const std::filesystem::path& object,
                                             const std::string& camera);

// The depth camera of `camera`: calibrated as such, or else as the infrared camera that it is.
// Errors as ReadHdf5; INVALID_ARGUMENT when a focal length or the scale is not positive.
absl::StatusOr<DepthLens> ReadLens(const std::filesystem::path& object, const std::string& camera);

}  // namespace graspdb::client
