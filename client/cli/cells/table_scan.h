// Scans of the empty table for the calibration commands.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/calibration/target/still_scan.h"

namespace graspdb::client {

// A frame in a file, sensor frame, metres. Errors as ReadPointFile.
absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path);

// The frame in the file `frame`, or for "" the mean of some frames of the camera `sensor` (see
// OpenSensor), waiting some seconds for it. Errors as FrameFrom; or as OpenCamera and
// TakeStillScan.
absl::StatusOr<StillScan> TableFrom(const std::string& frame, const std::string& sensor);

}  // namespace graspdb::client
