// The recognition service with components that a test can access.
#pragma once

#include <grpcpp/server.h>

#include <memory>

#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/calls/admission.h"
#include "server/calls/call_guard.h"
#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"
#include "server/recognition/frame_recognizer.h"
#include "server/recognition/recognition_service.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::testing {

// An empty catalogue in `directory`; `slots` frames at once, `waiting` more may wait.
class ServiceRig {
 public:
  ServiceRig(const std::string& directory, int slots, int waiting);
  ~ServiceRig();

  server::Admission& admission() { return admission_; }
  server::FrameRecognizer& recognizer() { return recognizer_; }
  storage::Catalogue& catalogue() { return *catalogue_; }

  v1::RecognitionService::Stub& stub() { return *stub_; }
  // To be called before the first call.
  void LimitCalls(const server::CallPlaces::Limits& limits) {
    access_.places = std::make_unique<server::CallPlaces>(limits);
  }

  // A call with a deadline `timeout_ms` from now.
  grpc::Status Recognize(const v1::RecognizeRequest& request, int timeout_ms);

 private:
  recognition::RecognitionParameters parameters_;
  std::unique_ptr<storage::Catalogue> catalogue_;
  std::unique_ptr<server::LiveCatalogue> live_;
  server::ViewCloudCache clouds_;
  server::Admission admission_;
  server::FrameRecognizer recognizer_;
  server::CatalogueCheck check_;
  server::RequestMemory memory_{std::size_t{1} << 30U};
  server::RecognitionService service_;
  server::AccessRules access_ = {};  // all calls are allowed
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::RecognitionService::Stub> stub_;
};

}  // namespace graspdb::testing
