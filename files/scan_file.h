// Files of captures: point files and depth images.
#pragma once

#include <filesystem>
#include <optional>

#include "absl/status/statusor.h"
#include "files/messages/scan_message.h"
#include "recognition/base/types.h"

namespace graspdb::files {

struct ScanFile {
  ScanMessage scan;
  // T_world_sensor of a point file, see PointFile; depth images have none.
  std::optional<recognition::Pose> sensor_pose = {};
};

// Whether the extension is one that ReadScanFile reads: .pcd, .ply or .png, whatever its case.
bool IsScanFile(const std::filesystem::path& path);

// Reads a .png with 16-bit depths and intrinsics.json in the same folder (see depth_png.h), any
// other path as a point file (see point_file.h). An image of a lens with distortion becomes a cloud
// of its undistorted points: its pixels are no pinhole image. Errors as their readers. Thread-safe.
absl::StatusOr<ScanFile> ReadScanFile(const std::filesystem::path& path);

}  // namespace graspdb::files
