// One look: a frame from the camera, and what the server says of it.
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "absl/status/statusor.h"
#include "absl/synchronization/notification.h"
#include "absl/time/time.h"
#include "client/cell/agent/cell_cache.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace graspdb::client {

struct Look {
  v1::RecognizeRequest request;  // of the last attempt; without a scan where there was no frame
  v1::RecognizeResponse response;
  KeptCell cell;                                      // that the request was made with
  absl::Duration camera_time = absl::ZeroDuration();  // waiting for the frame
};

// Looks. Thread-safe.
class CaptureAndRecognize {
 public:
  // All must outlive this. `name` is the cell's resource name.
  CaptureAndRecognize(DepthSensor& sensor, Client& client, CellCache& cell, std::string name)
      : sensor_(sensor), client_(client), cell_(cell), name_(std::move(name)) {}

  // Tries again, with longer and longer pauses, while camera or server are away and `deadline` lets
  // it; then, or when stopped:
  // ABORTED when the camera gives nothing, UNAVAILABLE when the server is not there or has no time,
  // DEADLINE_EXCEEDED when it took too long. At once: errors of WorldSensor and of CellCache::Get;
  // DATA_LOSS when the server refuses (see Refusal). `look` is filled in as far as it came.
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
  CellCache& cell_;
  const std::string name_;
  absl::Notification stopped_;
};

}  // namespace graspdb::client
