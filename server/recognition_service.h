// RecognitionService.
#pragma once

#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/admission.h"
#include "server/frame_recognizer.h"

namespace graspdb::server {

// Thread-safe. The references must outlive it.
class RecognitionService final : public v1::RecognitionService::Service {
 public:
  RecognitionService(FrameRecognizer& recognizer, Admission& admission)
      : recognizer_(recognizer), admission_(admission) {}

  grpc::Status Recognize(grpc::ServerContext* context, const v1::RecognizeRequest* request,
                         v1::RecognizeResponse* response) override;
  grpc::Status RecognizeStream(
      grpc::ServerContext* context,
      grpc::ServerReaderWriter<v1::RecognizeStreamResponse, v1::RecognizeStreamRequest>* stream)
      override;

 private:
  absl::Status RecognizeOne(const grpc::ServerContext& context, const v1::RecognizeRequest& request,
                            v1::RecognizeResponse* response);

  FrameRecognizer& recognizer_;
  Admission& admission_;
};

}  // namespace graspdb::server
