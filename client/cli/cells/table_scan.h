// The empty table, as commands that calibrate are shown it.
#pragma once

#include <filesystem>
#include <string>

#include "absl/status/statusor.h"
#include "client/cell/calibration/still_scan.h"

namespace graspdb::client {

// A frame in a file, sensor frame, metres. Errors as ReadPointFile.
absl::StatusOr<StillScan> FrameFrom(const std::filesystem::path& path);

// The frame in the file `frame`, or for "" the mean of some frames of the camera `sensor` (see
// OpenSensor), which has some seconds to come. Errors as FrameFrom; or as OpenCamera and
// TakeStillScan.
absl::StatusOr<StillScan> TableFrom(const std::string& frame, const std::string& sensor);

}  // namespace graspdb::client
