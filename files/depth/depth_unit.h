// The unit and the invalid counts of depth images, as camera files name them; internal to the
// reader of depth images.
#pragma once

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "files/depth/camera_entries.h"

namespace graspdb::files {

// Metres per count; 0.001 where no key names a unit. Programs use the same names for different
// units, but no depth camera has two of these, so the number decides for keys of scales and
// factors:
//   0.00001 to 0.002   metres per count (RealSense)
//   0.02 to 2          millimetres per count (BOP)
//   100 to 100,000     counts per metre (Open3D, TUM)
// INVALID_ARGUMENT with the key, without the file's name, for other numbers, for keys that
// contradict each other, and for unknown keys of units.
absl::StatusOr<double> DepthUnitOf(const std::vector<CameraEntry>& entries);

// The counts that the file declares as no measurement, besides 0 and 65535.
absl::StatusOr<std::vector<std::uint16_t>> InvalidCountsOf(const std::vector<CameraEntry>& entries);

}  // namespace graspdb::files
