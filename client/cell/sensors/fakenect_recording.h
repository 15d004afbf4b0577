// Recordings that libfreenect's fakenect library plays in the place of a Kinect v1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/sensors/kinect_v1_calibration.h"
#include "rendering/depth_camera.h"

namespace graspdb::client {

// Writes a recording: INDEX.txt with a file a line, "d-SECONDS-TICKS.pgm" with a line of PGM header
// and the raw 11-bit disparities as little-endian 16-bit numbers, and device.json, by which newer
// libraries know the calibration. The format is that of fakenect-record (libfreenect 0.5); pictures
// and accelerations are not written. Played with
//
//   fakenect FOLDER PROGRAM ...
//
// Debian's library ends with the last frame, as if the camera were unplugged; newer ones begin
// again, unless FAKENECT_LOOP is 0. Not thread-safe.
class FakenectRecording {
 public:
  // ALREADY_EXISTS when there is a recording in `folder`; the errors of WriteFileAtomically.
  static absl::StatusOr<FakenectRecording> Create(const std::filesystem::path& folder,
                                                  const KinectV1Calibration& calibration = {});

  // Shows `frame` (640 x 480) for `duration`, 30 times a second and once at least: the camera
  // stands still. INVALID_ARGUMENT for another size; the errors of WriteFileAtomically.
  absl::Status Show(const DepthFrame& frame, absl::Duration duration);
  // The same with raw disparities, row by row, as a camera sent them.
  absl::Status ShowRaw(const std::vector<std::uint16_t>& raw, absl::Duration duration);

  // Where the camera is pulled out: the library reports an error here, once, and goes on with what
  // follows when it is opened again.
  absl::Status PullOut();

  // Writes INDEX.txt: before this there is no recording.
  absl::Status Finish();

 private:
  FakenectRecording(std::filesystem::path folder, const KinectV1Calibration& calibration)
      : folder_(std::move(folder)), calibration_(calibration) {}
  std::string NextName();

  std::filesystem::path folder_;
  KinectV1Calibration calibration_;
  std::int64_t frames_ = 0;
  std::string index_;
};

}  // namespace graspdb::client
