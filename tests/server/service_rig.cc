#include "tests/server/service_rig.h"

#include <grpcpp/server_builder.h>
#include <spdlog/spdlog.h>

#include <chrono>

namespace graspdb::testing {
namespace {

constexpr std::size_t kMaxPoints = 1'000'000;

}  // namespace

ServiceRig::ServiceRig(const std::string& directory, int slots, int waiting)
    : catalogue_(storage::Catalogue::Open(directory).value()),
      live_(server::LiveCatalogue::Follow(*catalogue_, parameters_.descriptor).value()),
      clouds_(*catalogue_, parameters_.descriptor, 1U << 20),
      admission_(slots, waiting),
      recognizer_(*catalogue_, *live_, clouds_, parameters_, kMaxPoints),
      check_(*live_, clouds_, parameters_),
      service_(recognizer_, check_, admission_, memory_) {
  spdlog::set_level(spdlog::level::off);
  grpc::ServerBuilder builder;
  builder.RegisterService(&service_);
  server::GuardCalls(access_, builder);
  server_ = builder.BuildAndStart();
  stub_ = v1::RecognitionService::NewStub(server_->InProcessChannel(grpc::ChannelArguments()));
}

ServiceRig::~ServiceRig() { server_->Shutdown(); }

grpc::Status ServiceRig::Recognize(const v1::RecognizeRequest& request, int timeout_ms) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(timeout_ms));
  v1::RecognizeResponse response;
  return stub_->Recognize(&context, request, &response);
}

}  // namespace graspdb::testing
