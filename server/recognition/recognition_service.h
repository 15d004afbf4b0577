// RecognitionService.
#pragma once

#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/calls/admission.h"
#include "server/calls/memory_budget.h"
#include "server/recognition/catalogue_check.h"
#include "server/recognition/frame_recognizer.h"

namespace graspdb::server {

// Thread-safe. The references must outlive it.
class RecognitionService final : public v1::RecognitionService::Service {
 public:
  RecognitionService(FrameRecognizer& recognizer, CatalogueCheck& check, Admission& admission,
                     RequestMemory& memory)
      : recognizer_(recognizer), check_(check), admission_(admission), memory_(memory) {}

  grpc::Status Recognize(grpc::ServerContext* context, const v1::RecognizeRequest* request,
                         v1::RecognizeResponse* response) override;
  grpc::Status RecognizeStream(
      grpc::ServerContext* context,
      grpc::ServerReaderWriter<v1::RecognizeStreamResponse, v1::RecognizeStreamRequest>* stream)
      override;
  grpc::Status FindLookAlikes(grpc::ServerContext* context,
                              const v1::FindLookAlikesRequest* request,
                              v1::FindLookAlikesResponse* response) override;
  grpc::Status ProposeThresholds(
      grpc::ServerContext* context, const v1::ProposeThresholdsRequest* request,
      grpc::ServerWriter<v1::ProposeThresholdsResponse>* stream) override;

 private:
  absl::Status RecognizeOne(const grpc::ServerContext& context, const v1::RecognizeRequest& request,
                            v1::RecognizeResponse* response);

  FrameRecognizer& recognizer_;
  CatalogueCheck& check_;
  Admission& admission_;
  RequestMemory& memory_;
};

}  // namespace graspdb::server
