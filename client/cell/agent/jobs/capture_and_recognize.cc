#include "client/cell/agent/jobs/capture_and_recognize.h"

#include <variant>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/sdk/connection.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "program/log/request_id.h"

namespace graspdb::client {
namespace {

// Spans of the random pauses, added to the delay of a busy server (BusyDelay). Half of a span is
// the mean.
constexpr absl::Duration kFirstPause = absl::Milliseconds(20);
constexpr absl::Duration kMaxPause = absl::Milliseconds(500);

bool IsTransient(const absl::Status& status) {
  return absl::IsAborted(status) || absl::IsUnavailable(status) || BusyDelay(status);
}

// Whether all pixels are 0, no measurement, as of a covered camera.
bool IsBlank(const files::ScanMessage& scan) {
  const auto* image = std::get_if<v1::DepthImage>(&scan);
  return image != nullptr && !image->data().empty() &&
         image->data().find_first_not_of('\0') == std::string::npos;
}

}  // namespace

absl::Status Refusal(const absl::Status& answered) {
  if (answered.ok() || absl::IsUnavailable(answered) || absl::IsDeadlineExceeded(answered)) {
    return answered;
  }
  if (BusyDelay(answered)) return absl::UnavailableError(answered.message());
  return absl::DataLossError(
      absl::StrCat(absl::StatusCodeToString(answered.code()), ": ", answered.message()));
}

absl::StatusOr<SensorFrame> CaptureAndRecognize::Grab(MonotonicTime deadline) {
  absl::StatusOr<SensorFrame> frame = sensor_.Next(deadline);
  if (frame.ok() && IsBlank(frame->scan)) {
    return absl::FailedPreconditionError(
        "the camera measures nothing, no pixel has a depth; is it covered, or too near?");
  }
  if (absl::IsUnavailable(frame.status()) || absl::IsDeadlineExceeded(frame.status())) {
    return absl::AbortedError(frame.status().message());
  }
  return frame;
}

absl::Status CaptureAndRecognize::Try(const std::optional<recognition::Pose>& base_flange,
                                      MonotonicTime deadline, CaptureResult* capture) {
  capture->request.Clear();
  capture->camera = absl::OkStatus();
  capture->request_id.clear();
  capture->catalog_revision = last_revision_;
  ASSIGN_OR_RETURN(const KeptCell cell, cell_.Get(deadline));
  capture->cell = cell;
  const MonotonicTime start = MonotonicTime::Now();
  absl::StatusOr<SensorFrame> frame = Grab(deadline);
  capture->camera_time += MonotonicTime::Now() - start;
  capture->camera = frame.status();
  if (!frame.ok()) return frame.status();
  capture->frame_time = frame->time;
  ASSIGN_OR_RETURN(const recognition::Pose world_sensor,
                   WorldSensor(cell.frames, base_flange, frame->world_sensor));
  capture->request.set_cell(name_);
  *capture->request.mutable_sensor_pose() = files::ToMessage(world_sensor);
  files::SetScan(std::move(frame->scan), &capture->request);
  capture->request_id = MakeRequestId();
  absl::StatusOr<v1::RecognizeResponse> response =
      client_.Recognize(capture->request, deadline - MonotonicTime::Now(), capture->request_id);
  capture->answered = response.status();
  if (BusyDelay(response.status())) return response.status();  // Run waits for so long
  if (!response.ok()) return Refusal(response.status());
  capture->response = *std::move(response);
  last_revision_ = capture->catalog_revision = capture->response.catalog_revision();
  // After an outage; robots and monitoring need not wait for the next periodic read.
  if (!cell_.state().ok()) (void)cell_.Refresh(deadline - MonotonicTime::Now());
  return absl::OkStatus();
}

absl::Status CaptureAndRecognize::Run(const std::optional<recognition::Pose>& base_flange,
                                      MonotonicTime deadline, CaptureResult* capture) {
  Backoff backoff(kFirstPause, kMaxPause);
  absl::Status no_server;
  for (;;) {
    absl::Status status = Try(base_flange, deadline, capture);
    if (status.ok()) return status;
    if (absl::IsUnavailable(status)) no_server = status;
    if (absl::IsDeadlineExceeded(status)) {  // the server is unreachable, not slow
      if (absl::IsUnavailable(cell_.state())) return cell_.state();
      return no_server.ok() ? status : no_server;
    }
    if (!IsTransient(status)) {  // the code of a camera's error would accuse the robot's request
      return capture->camera.ok() ? status : absl::AbortedError(status.message());
    }
    const absl::Duration pause = backoff.Next(BusyDelay(status).value_or(absl::ZeroDuration()));
    const bool is_late = MonotonicTime::Now() + pause >= deadline;
    if (is_late || stopped_.Wait(absl::ToChronoNanoseconds(pause))) {
      // The server was unavailable, and no time was left for another frame.
      if (absl::IsAborted(status) && !no_server.ok()) return no_server;
      return absl::IsResourceExhausted(status) ? absl::UnavailableError(status.message()) : status;
    }
  }
}

void CaptureAndRecognize::Stop() { stopped_.Raise(); }

}  // namespace graspdb::client
