// RecognitionService.
#pragma once

#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/admission.h"
#include "server/frame_recognizer.h"
#include "server/look_alike_finder.h"

namespace graspdb::server {

// Thread-safe. The references must outlive it.
class RecognitionService final : public v1::RecognitionService::Service {
 public:
  RecognitionService(FrameRecognizer& recognizer, LookAlikeFinder& look_alikes,
                     Admission& admission)
      : recognizer_(recognizer), look_alikes_(look_alikes), admission_(admission) {}

  grpc::Status Recognize(grpc::ServerContext* context, const v1::RecognizeRequest* request,
                         v1::RecognizeResponse* response) override;
  grpc::Status RecognizeStream(
      grpc::ServerContext* context,
      grpc::ServerReaderWriter<v1::RecognizeStreamResponse, v1::RecognizeStreamRequest>* stream)
      override;
  grpc::Status FindLookAlikes(grpc::ServerContext* context,
                              const v1::FindLookAlikesRequest* request,
                              v1::FindLookAlikesResponse* response) override;

 private:
  absl::Status RecognizeOne(const grpc::ServerContext& context, const v1::RecognizeRequest& request,
                            v1::RecognizeResponse* response);

  FrameRecognizer& recognizer_;
  LookAlikeFinder& look_alikes_;
  Admission& admission_;
};

}  // namespace graspdb::server
