// One capture and its recognition result.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "client/cell/agent/jobs/cell_cache.h"
#include "client/cell/sensors/depth_sensor.h"
#include "client/sdk/client.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "program/base/monotonic_time.h"
#include "program/base/stop_flag.h"

namespace graspdb::client {

// Maps the status of a call to the server to JobRunner's errors: UNAVAILABLE and DEADLINE_EXCEEDED
// stay; RESOURCE_EXHAUSTED of a busy server (see BusyDelay) becomes UNAVAILABLE; every other error
// becomes DATA_LOSS, and its message starts with the server's code. Otherwise NOT_FOUND for a
// missing view would be taken for a missing job.
absl::Status Refusal(const absl::Status& answered);

struct CaptureResult {
  v1::RecognizeRequest request;  // of the last attempt; without a scan if there was no frame
  v1::RecognizeResponse response;
  absl::Status camera;                // of the last attempt to get a frame
  absl::Status answered;              // the server's status for the request
  std::string request_id;             // of the last call; empty without one
  std::int64_t catalog_revision = 0;  // of the response, or of an earlier one; 0: unknown
  MonotonicTime frame_time = MonotonicTime::InfinitePast();  // of the last frame
  KeptCell cell;                                             // used for the request
  absl::Duration camera_time = absl::ZeroDuration();         // waiting for the frame
};

// Captures a frame and sends it to the server. Thread-safe.
class CaptureAndRecognize {
 public:
  // All must outlive this. `name` is the cell's resource name.
  CaptureAndRecognize(DepthSensor& sensor, Client& client, CellCache& cell, std::string name)
      : sensor_(sensor), client_(client), cell_(cell), name_(std::move(name)) {}

  // Retries with increasing, random pauses while camera or server are unavailable or the server is
  // busy (after its BusyDelay), with a new frame each time, until `deadline` or Stop;
  // then ABORTED when the camera gives no frame, UNAVAILABLE when the server is unreachable or
  // busy, DEADLINE_EXCEEDED when it is too slow. Not retried: errors of WorldSensor and
  // CellCache::Get; other errors of the camera and frames without any depth, which become ABORTED;
  // DATA_LOSS when the server rejects the request (see Refusal). `capture` is filled in on errors,
  // too, as far as possible.
  absl::Status Run(const std::optional<recognition::Pose>& base_flange, MonotonicTime deadline,
                   CaptureResult* capture);

  // Ends running calls at their next pause.
  void Stop();

 private:
  absl::Status Try(const std::optional<recognition::Pose>& base_flange, MonotonicTime deadline,
                   CaptureResult* capture);
  absl::StatusOr<SensorFrame> Grab(MonotonicTime deadline);

  DepthSensor& sensor_;
  Client& client_;
  CellCache& cell_;
  const std::string name_;
  std::atomic<std::int64_t> last_revision_ = 0;
  StopFlag stopped_;
};

}  // namespace graspdb::client
