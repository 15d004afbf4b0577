// Recordings that libfreenect's fakenect library plays instead of a Kinect v1.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/capture_plan.h"
#include "rendering/workpiece.h"

namespace graspdb::client {

// Writes a recording: INDEX.txt with one file per line, "d-SECONDS-TICKS.pgm" with a line of PGM
// header and the raw 11-bit disparities as little-endian 16-bit numbers, and device.json, from
// which newer libraries read the calibration. The format is that of fakenect-record (libfreenect
// 0.5), without images and accelerations. Played with
//
//   fakenect FOLDER PROGRAM ...
//
// Debian's library ends after the last frame, as if the camera were unplugged; newer ones loop,
// unless FAKENECT_LOOP is 0. Not thread-safe.
class FakenectRecording {
 public:
  // ALREADY_EXISTS when `folder` contains a recording; the errors of WriteFileAtomically.
  static absl::StatusOr<FakenectRecording> Create(const std::filesystem::path& folder);

  // Repeats `frame` (640 x 480) for `duration`, 30 times a second and at least once.
  // INVALID_ARGUMENT for another size; the errors of WriteFileAtomically.
  absl::Status Show(const rendering::DepthFrame& frame, absl::Duration duration);
  // The same with the camera's raw disparities, row by row.
  absl::Status ShowRaw(const std::vector<std::uint16_t>& raw, absl::Duration duration);

  // Simulates an unplugged camera: the library reports an error here, once, and continues after the
  // camera is reopened.
  absl::Status PullOut();

  // Writes INDEX.txt, which completes the recording.
  absl::Status Finish();

 private:
  explicit FakenectRecording(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::string NextName();

  std::filesystem::path folder_;
  std::int64_t frames_ = 0;
  std::string index_;
};

// Writes a recording for fakenect (see fakenect_recording.h): each scene of `plan` as rendered by
// SimulatedKinectV1, repeated for `duration`, and the ground truth (see scene_file.h). One image is
// stored per scene, so its noise does not change during `duration`.
//
// Errors as FakenectRecording and DepthCamera::Render; INVALID_ARGUMENT for a scene with a
// workpiece that is not in `parts`, or without scenes.
absl::Status WriteSimulatedRecording(const std::filesystem::path& folder,
                                     const std::vector<rendering::Workpiece>& parts,
                                     const std::vector<rendering::PlannedCapture>& plan,
                                     absl::Duration duration);

}  // namespace graspdb::client
