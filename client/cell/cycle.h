// One look: a frame from the camera, and what the server says of it.
#pragma once

#include <optional>

#include "absl/status/statusor.h"
#include "absl/synchronization/notification.h"
#include "absl/time/time.h"
#include "client/api/client.h"
#include "client/cell/cell_keeper.h"
#include "client/sensors/depth_sensor.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

struct CycleOptions {
  std::string cell;                                 // resource name
  absl::Duration max_frame_age = absl::Seconds(1);  // older ones are no answer
};

struct Look {
  v1::RecognizeRequest request;  // of the last attempt; without a scan where there was no frame
  v1::RecognizeResponse response;
  KeptCell cell;                                      // that the request was made with
  absl::Duration camera_time = absl::ZeroDuration();  // waiting for the frame
  absl::Duration server_time = absl::ZeroDuration();  // asking, all attempts
};

// Looks. Thread-safe.
class Cycle {
 public:
  // All must outlive this.
  Cycle(DepthSensor& sensor, Client& client, CellKeeper& cell, CycleOptions options)
      : sensor_(sensor), client_(client), cell_(cell), options_(std::move(options)) {}

  // Tries again, with longer and longer pauses, while camera or server are away and `deadline` lets
  // it; then, or when stopped:
  // ABORTED when the camera gives nothing, UNAVAILABLE when the server is not there or has no time,
  // DEADLINE_EXCEEDED when it took too long. At once: errors of WorldSensor, of CellKeeper::Get and
  // of the server. `look` is filled in as far as it came.
  absl::Status Run(const std::optional<recognition::Pose>& base_flange, absl::Time deadline,
                   Look* look);

  // Ends what runs, at the next pause.
  void Stop();

 private:
  absl::Status Try(const std::optional<recognition::Pose>& base_flange, absl::Time deadline,
                   Look* look);
  absl::StatusOr<SensorFrame> Grab(absl::Time deadline);

  DepthSensor& sensor_;
  Client& client_;
  CellKeeper& cell_;
  const CycleOptions options_;
  absl::Notification stopped_;
};

}  // namespace graspdb::client
