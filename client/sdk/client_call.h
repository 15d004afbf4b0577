// How the client makes calls; internal to the client library.
#pragma once

#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/support/sync_stream.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/sdk/client.h"
#include "client/sdk/connection.h"
#include "client/sdk/security.h"
#include "graspdb/v1/backup_service.grpc.pb.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/change_service.grpc.pb.h"
#include "graspdb/v1/object_history_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "program/base/monotonic_time.h"
#include "program/base/stop_flag.h"
#include "program/log/request_id.h"
#include "program/tls/watched_files.h"

namespace graspdb::client {

struct Client::Stubs {
  explicit Stubs(const std::shared_ptr<grpc::Channel>& channel)
      : backups(v1::BackupService::NewStub(channel)),
        catalog(v1::CatalogService::NewStub(channel)),
        cells(v1::CellService::NewStub(channel)),
        changes(v1::ChangeService::NewStub(channel)),
        history(v1::ObjectHistoryService::NewStub(channel)),
        recognition(v1::RecognitionService::NewStub(channel)),
        uploads(v1::UploadService::NewStub(channel)) {}
  std::unique_ptr<v1::BackupService::Stub> backups;
  std::unique_ptr<v1::CatalogService::Stub> catalog;
  std::unique_ptr<v1::CellService::Stub> cells;
  std::unique_ptr<v1::ChangeService::Stub> changes;
  std::unique_ptr<v1::ObjectHistoryService::Stub> history;
  std::unique_ptr<v1::RecognitionService::Stub> recognition;
  std::unique_ptr<v1::UploadService::Stub> uploads;
  StopFlag stopped;                            // of StopRetries()
  absl::Status usable;                         // of the options: the error of every call
  std::unique_ptr<WatchedFiles> tls_files;     // null: none
  std::unique_ptr<Reconnection> reconnection;  // null: of a channel of the caller
};

template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> Client::Call(Stub& stub, Method<Stub, Request, Response> method,
                                      const Request& request, const CallSettings& settings) const {
  const MonotonicTime deadline = MonotonicTime::Now() + settings.timeout;
  BusyRetries retries(settings.retry ? busy_retries() : 0);
  for (;;) {
    absl::StatusOr<Response> response =
        Attempt(stub, method, request, deadline - MonotonicTime::Now(), settings.request_id);
    if (response.ok()) return response;
    const std::optional<absl::Duration> pause = retries.Next(response.status(), deadline);
    if (!pause || stubs_->stopped.Wait(absl::ToChronoNanoseconds(*pause))) return response;
  }
}

template <typename Stub, typename Request, typename Response>
absl::StatusOr<Response> Client::Attempt(Stub& stub, Method<Stub, Request, Response> method,
                                         const Request& request, absl::Duration timeout,
                                         const std::string& request_id) const {
  // A server that is open to all would not miss it.
  RETURN_IF_ERROR(CheckToken(options_));
  grpc::ClientContext context;
  if (!request_id.empty()) context.AddMetadata(kRequestIdKey, request_id);
  // gRPC converts it to its monotonic clock at the start of the call.
  context.set_deadline(absl::ToChronoTime(absl::Now() + timeout));
  Response response;
  const grpc::Status status = (stub.*method)(&context, request, &response);
  if (!status.ok()) return ToStatus(status, context);
  return response;
}

template <typename Response, typename OnMessage>
absl::StatusOr<Response> Client::LastMessage(grpc::ClientContext& context,
                                             std::unique_ptr<grpc::ClientReader<Response>> reader,
                                             const OnMessage& on_message) const {
  Response message;
  while (reader->Read(&message)) {
    absl::Status status = on_message(message);
    if (status.ok()) continue;
    context.TryCancel();
    (void)reader->Finish();  // cancelled here; the caller's error has the reason
    return status;
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return ToStatus(status, context);
  return message;
}

template <typename Stub, typename Request, typename Response, typename Record>
absl::StatusOr<std::vector<Record>> Client::ListAll(
    Stub& stub, Method<Stub, Request, Response> method, Request request,
    google::protobuf::RepeatedPtrField<Record>* (Response::*records)()) const {
  std::vector<Record> out;
  do {
    ASSIGN_OR_RETURN(Response page, Call(stub, method, request));
    for (Record& record : *(page.*records)()) out.push_back(std::move(record));
    request.set_page_token(page.next_page_token());
  } while (!request.page_token().empty());
  return out;
}

// A request for the resource of that name.
template <typename Request>
Request Named(const std::string& name) {
  Request request;
  request.set_name(name);
  return request;
}

}  // namespace graspdb::client
