// Point clouds in PCD and PLY files.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "files/base/atomic_file.h"
#include "recognition/base/types.h"

namespace graspdb::files {

// Files that declare more points are rejected before anything is allocated.
inline constexpr int kMaxPoints = 10'000'000;

// The content of a point file.
struct PointFile {
  // Sensor frame, metres, in the order of the file; NaN in all three components
  // where there is no measurement (a NaN, an infinity or (0, 0, 0) in the file).
  recognition::Points points;
  // Empty, or one per point when the file has normal_x, normal_y and normal_z
  // (nx, ny, nz in PLY); as in the file, so possibly NaN or not of length one.
  recognition::Normals normals;
  // Organised (an image, row by row) when height > 1; width * height points.
  int width = 0;
  int height = 0;
  // Columns of the image, 0 if it is not an image.
  int image_width() const { return height > 1 ? width : 0; }
  // T_world_sensor from the VIEWPOINT line of a PCD file; empty when the line is
  // absent or the identity, which means unknown. PLY files have none.
  std::optional<recognition::Pose> sensor_pose;
};

// Reads `path`: .pcd (ascii, binary, binary_compressed) or .ply (ascii, binary of
// either byte order), whatever the case of the extension. x, y and z may be
// single or double precision; other fields are ignored. Safe on any bytes: the
// body is checked against the header before it is decoded.
//
// NOT_FOUND when there is no such file, INVALID_ARGUMENT when it is of another kind
// or damaged, each with the path, the error and advice. Thread-safe.
absl::StatusOr<PointFile> ReadPointFile(const std::filesystem::path& path);

// Writes a binary_compressed PCD file atomically; by default without waiting for the disk.
// `file.points` must have width * height points and `file.normals` none or as many;
// points without measurement are written as NaN, and without `sensor_pose` the
// VIEWPOINT line is the identity. Single precision, the pose too. The same file gives
// the same bytes.
//
// INVALID_ARGUMENT for other counts, no points, or more than kMaxPoints;
// otherwise the errors of WriteFileAtomically.
absl::Status WritePcd(const std::filesystem::path& path, const PointFile& file,
                      Durability durability = Durability::kProcessCrash);

}  // namespace graspdb::files
