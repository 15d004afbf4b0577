// PCD files of the real data, read with PCL's own reader.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "recognition/base/types.h"

namespace graspdb::testing {

struct PcdCloud {
  recognition::OrientedCloud cloud;   // normals only when the file has them
  std::vector<std::uint32_t> labels;  // only when the file has them
};

// Fails the calling test when the file is not readable.
PcdCloud ReadPcd(const std::filesystem::path& path);

}  // namespace graspdb::testing
