// The header of a PCD file, parsed strictly before any of its sizes is used.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"

namespace graspdb::files {

// A PCD header; see the file format page of PCL.
struct PcdHeader {
  enum class Encoding { kAscii, kBinary, kBinaryCompressed };

  struct Field {
    std::string name;
    int size = 0;   // bytes of one element: 1, 2, 4 or 8
    char type = 0;  // 'F', 'I' or 'U'
    int count = 1;  // elements in a point
  };

  std::vector<Field> fields;
  int width = 0;
  int height = 0;
  // T_world_sensor; empty when VIEWPOINT is absent or the identity.
  std::optional<recognition::Pose> sensor_pose;
  Encoding encoding = Encoding::kAscii;
  // Where the body begins, in bytes from the start of the file.
  std::size_t body_offset = 0;

  std::int64_t point_count() const { return std::int64_t{width} * height; }
  // Bytes of a point in a binary body.
  std::int64_t point_bytes() const;
  // Numbers of a point, which are the words of an ascii row.
  int numbers_per_point() const;
};

// Reads the header of the file at `path`. On success x, y and z exist once each as
// single numbers of 4 or 8 bytes, there are 1 to kMaxPoints points, and the declared
// body is smaller than 4 GiB.
//
// INVALID_ARGUMENT with the path and the first invalid line.
absl::StatusOr<PcdHeader> ReadPcdHeader(const std::filesystem::path& path);

}  // namespace graspdb::files
