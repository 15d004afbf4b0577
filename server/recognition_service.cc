#include "server/recognition_service.h"

#include <utility>

#include "server/errors.h"
#include "server/handle.h"

namespace graspdb::server {

namespace {

// Does `work`, which is asked whether the call is abandoned, when there is room for it.
template <typename Response, typename Work>
absl::Status Admitted(const grpc::ServerContext& context, Admission& admission, const Work& work,
                      Response* response) {
  const auto is_cancelled = [&] { return IsAbandoned(context); };
  absl::StatusOr<Admission::Ticket> ticket = admission.Enter(is_cancelled);
  if (!ticket.ok()) return ticket.status();
  absl::StatusOr<Response> answer = work(is_cancelled);
  if (!answer.ok()) return answer.status();
  *response = *std::move(answer);
  return absl::OkStatus();
}

}  // namespace

absl::Status RecognitionService::RecognizeOne(const grpc::ServerContext& context,
                                              const v1::RecognizeRequest& request,
                                              v1::RecognizeResponse* response) {
  const auto answer = [&](const auto& is_cancelled) {
    return recognizer_.Answer(request, is_cancelled);
  };
  return Admitted(context, admission_, answer, response);
}

grpc::Status RecognitionService::Recognize(grpc::ServerContext* context,
                                           const v1::RecognizeRequest* request,
                                           v1::RecognizeResponse* response) {
  return Handle(*context, "Recognize", [&] { return RecognizeOne(*context, *request, response); });
}

grpc::Status RecognitionService::FindLookAlikes(grpc::ServerContext* context,
                                                const v1::FindLookAlikesRequest* request,
                                                v1::FindLookAlikesResponse* response) {
  return Handle(*context, "FindLookAlikes", [&] {
    const auto answer = [&](const auto& is_cancelled) {
      return look_alikes_.Answer(*request, is_cancelled);
    };
    return Admitted(*context, admission_, answer, response);
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
