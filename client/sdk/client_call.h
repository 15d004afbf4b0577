// How the client makes calls; internal to the client library.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>

#include <memory>

#include "absl/time/clock.h"
#include "client/sdk/client.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"

namespace graspdb::client {

struct Client::Stubs {
  explicit Stubs(const std::shared_ptr<grpc::Channel>& channel)
      : catalog(v1::CatalogService::NewStub(channel)),
        cells(v1::CellService::NewStub(channel)),
        recognition(v1::RecognitionService::NewStub(channel)) {}
  std::unique_ptr<v1::CatalogService::Stub> catalog;
  std::unique_ptr<v1::CellService::Stub> cells;
  std::unique_ptr<v1::RecognitionService::Stub> recognition;
};

template <typename Response, typename Stub, typename Method, typename Request>
absl::StatusOr<Response> Client::Call(Stub& stub, Method method, const Request& request,
                                      absl::Duration timeout) const {
  grpc::ClientContext context;
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  Response response;
  const grpc::Status status = (stub.*method)(&context, request, &response);
  if (!status.ok()) return ToStatus(status);
  return response;
}

}  // namespace graspdb::client
