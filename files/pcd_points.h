// The points of a PCD file whose header and body were checked.
#pragma once

#include <filesystem>

#include "absl/status/statusor.h"
#include "files/pcd_header.h"
#include "files/point_file.h"

namespace graspdb::client {

// Decodes a file that passed ReadPcdHeader and CheckPcdBody; `sensor_pose` is left empty. Read here
// and not by PCL, whose reader parses the header once more, takes some lines otherwise and then
// crashes. INVALID_ARGUMENT when the compressed bytes cannot be unpacked. Takes a few times the
// memory of the file, or of what its bytes unpack to.
absl::StatusOr<PointFile> DecodePcd(const std::filesystem::path& path, const PcdHeader& header);

}  // namespace graspdb::client
