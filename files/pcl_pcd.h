// PCL's PCD writer; pcl_pcd.cc is the only file that uses PCL's types.
#pragma once

#include <string>

#include "absl/status/statusor.h"
#include "files/point_file.h"

namespace graspdb::client {

// The bytes of a binary_compressed PCD file; `file` must be consistent, as
// WritePcd checks. INTERNAL when PCL rejects it. Silences PCL's console for the process.
absl::StatusOr<std::string> EncodePcd(const PointFile& file);

}  // namespace graspdb::client
