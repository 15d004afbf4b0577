#include "server/recognition/recognition_service.h"

#include <functional>
#include <optional>
#include <utility>

#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "base/status_macros.h"
#include "server/base/errors.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "server/recognition/answer.h"
#include "server/requests/request_limits.h"

namespace graspdb::server {

namespace {

// How often long work retries while the queue is full.
constexpr absl::Duration kRetryInterval = absl::Milliseconds(50);

// Runs `work`, which gets the check for an abandoned call, once it has a slot.
template <typename Response, typename Work>
absl::Status Admitted(const grpc::ServerContext& context, Admission& admission, const Work& work,
                      Response* response) {
  AbandonedWatch watch(context);
  const auto is_cancelled = [&] { return watch.IsAbandoned(); };
  ASSIGN_OR_RETURN(Admission::Ticket ticket, admission.Enter(is_cancelled));
  ASSIGN_OR_RETURN(Response answer, work(is_cancelled));
  *response = std::move(answer);
  return absl::OkStatus();
}

// Retries while the queue is full, for long work.
absl::Status EnterWithRetries(Admission& admission, const std::function<bool()>& is_cancelled,
                              std::optional<Admission::Ticket>* ticket) {
  for (;;) {
    absl::StatusOr<Admission::Ticket> next = admission.Enter(is_cancelled);
    if (next.ok()) {
      ticket->emplace(*std::move(next));
      return absl::OkStatus();
    }
    if (!absl::IsResourceExhausted(next.status())) return next.status();
    if (is_cancelled()) return absl::CancelledError("the call was cancelled while it was waiting");
    absl::SleepFor(kRetryInterval);
  }
}

// A response for the log and the metrics.
void Note(const std::string& cell, const v1::RecognizeResponse& response, absl::Duration waited,
          CallGuard& guard) {
  if (!cell.empty()) guard.NoteForLog("cell", cell);
  guard.NoteForLog("status", v1::RecognitionStatus_Name(response.status()));
  if (guard.metrics() != nullptr) guard.metrics()->CountFrame(cell, response, waited);
}

}  // namespace

absl::Status RecognitionService::RecognizeOne(const grpc::ServerContext& context,
                                              const v1::RecognizeRequest& request,
                                              v1::RecognizeResponse* response) {
  ASSIGN_OR_RETURN(const auto memory,
                   memory_.Reserve(RequestMemory::kBytesPerWireByte * request.ByteSizeLong()));
  const absl::Time arrival = absl::Now();
  absl::Duration waited;
  const auto answer = [&](const auto& is_cancelled) {
    waited = absl::Now() - arrival;
    return recognizer_.Answer(request, is_cancelled);
  };
  RETURN_IF_ERROR(Admitted(context, admission_, answer, response));
  Note(request.cell(), *response, waited, *CallGuard::Of(context));
  if (request.omit_timings()) LeaveOutTimings(response);
  return absl::OkStatus();
}

grpc::Status RecognitionService::Recognize(grpc::ServerContext* context,
                                           const v1::RecognizeRequest* request,
                                           v1::RecognizeResponse* response) {
  return Handle(*context, "Recognize", *request,
                [&] { return RecognizeOne(*context, *request, response); });
}

grpc::Status RecognitionService::FindLookAlikes(grpc::ServerContext* context,
                                                const v1::FindLookAlikesRequest* request,
                                                v1::FindLookAlikesResponse* response) {
  return Handle(*context, "FindLookAlikes", *request, [&] {
    const auto answer = [&](const auto& is_cancelled) {
      return check_.FindLookAlikes(*request, is_cancelled);
    };
    return Admitted(*context, admission_, answer, response);
  });
}

// Each view waits for its own slot, so that the robots' frames run in between.
grpc::Status RecognitionService::ProposeThresholds(
    grpc::ServerContext* context, const v1::ProposeThresholdsRequest* request,
    grpc::ServerWriter<v1::ProposeThresholdsResponse>* stream) {
  return Handle(*context, "ProposeThresholds", *request, [&]() -> absl::Status {
    AbandonedWatch watch(*context);
    const auto is_cancelled = [&] { return watch.IsAbandoned(); };
    std::optional<Admission::Ticket> ticket;
    const auto progress = [&](std::size_t done, std::size_t count) -> absl::Status {
      ticket.reset();
      v1::ProposeThresholdsResponse message;
      message.set_done_view_count(static_cast<int>(done));
      message.set_view_count(static_cast<int>(count));
      if (!stream->Write(message)) return absl::CancelledError("the stream was cancelled");
      return EnterWithRetries(admission_, is_cancelled, &ticket);
    };
    ASSIGN_OR_RETURN(const auto answer, check_.ProposeThresholds(*request, is_cancelled, progress));
    ticket.reset();
    return stream->Write(answer) ? absl::OkStatus()
                                 : absl::CancelledError("the stream was cancelled");
  });
}

grpc::Status RecognitionService::RecognizeStream(
    grpc::ServerContext* context,
    grpc::ServerReaderWriter<v1::RecognizeStreamResponse, v1::RecognizeStreamRequest>* stream) {
  return Handle(*context, "RecognizeStream", [&]() -> absl::Status {
    for (;;) {
      // Not kept while the stream waits for the next one: nothing counts its memory then.
      v1::RecognizeStreamRequest frame;
      if (!stream->Read(&frame)) break;
      v1::RecognizeStreamResponse answer;
      const grpc::Status status = Handle(*context, "RecognizeStream.frame", frame.request(), [&] {
        RETURN_IF_ERROR(CheckLength(frame.frame_id(), "frame_id"));
        CallGuard::Of(*context)->NoteForLog("frame_id", frame.frame_id());
        return RecognizeOne(*context, frame.request(), answer.mutable_response());
      });
      answer.set_frame_id(BoundedText(frame.frame_id(), kMaxStringBytes));
      if (!status.ok()) answer.mutable_error()->ParseFromString(status.error_details());
      if (!stream->Write(answer)) return absl::CancelledError("the stream was cancelled");
    }
    return absl::OkStatus();
  });
}

}  // namespace graspdb::server
