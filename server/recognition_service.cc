#include "server/recognition_service.h"

#include <utility>

#include "server/errors.h"
#include "server/handle.h"

namespace graspdb::server {

absl::Status RecognitionService::RecognizeOne(const grpc::ServerContext& context,
                                              const v1::RecognizeRequest& request,
                                              v1::RecognizeResponse* response) {
  const auto is_cancelled = [&] { return IsAbandoned(context); };
  absl::StatusOr<Admission::Ticket> ticket = admission_.Enter(is_cancelled);
  if (!ticket.ok()) return ticket.status();
  absl::StatusOr<v1::RecognizeResponse> answer = recognizer_.Answer(request, is_cancelled);
  if (!answer.ok()) return answer.status();
  *response = *std::move(answer);
  return absl::OkStatus();
}

grpc::Status RecognitionService::Recognize(grpc::ServerContext* context,
                                           const v1::RecognizeRequest* request,
                                           v1::RecognizeResponse* response) {
  return Handle(*context, "Recognize", [&] { return RecognizeOne(*context, *request, response); });
}

grpc::Status RecognitionService::FindLookAlikes(grpc::ServerContext* context,
                                                const v1::FindLookAlikesRequest* request,
                                                v1::FindLookAlikesResponse* response) {
  return Handle(*context, "FindLookAlikes", [&]() -> absl::Status {
    const auto is_cancelled = [&] { return IsAbandoned(*context); };
    absl::StatusOr<Admission::Ticket> ticket = admission_.Enter(is_cancelled);
    if (!ticket.ok()) return ticket.status();
    absl::StatusOr<v1::FindLookAlikesResponse> answer = look_alikes_.Answer(*request, is_cancelled);
    if (!answer.ok()) return answer.status();
    *response = *std::move(answer);
    return absl::OkStatus();
  });
}

grpc::Status RecognitionService::RecognizeStream(
    grpc::ServerContext* context,
    grpc::ServerReaderWriter<v1::RecognizeStreamResponse, v1::RecognizeStreamRequest>* stream) {
  return Handle(*context, "RecognizeStream", [&]() -> absl::Status {
    v1::RecognizeStreamRequest frame;
    while (stream->Read(&frame)) {
      v1::RecognizeStreamResponse answer;
      answer.set_frame_id(frame.frame_id());
      const grpc::Status status = Handle(*context, "RecognizeStream.frame", [&] {
        return RecognizeOne(*context, frame.request(), answer.mutable_response());
      });
      if (!status.ok()) answer.mutable_error()->ParseFromString(status.error_details());
      if (!stream->Write(answer)) return absl::CancelledError("the caller left the stream");
    }
    return absl::OkStatus();
  });
}

}  // namespace graspdb::server
