#include "client/sdk/client.h"

#include <grpcpp/create_channel.h>

#include <memory>
#include <utility>

#include "absl/strings/cord.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "client/sdk/client_call.h"
#include "client/sdk/connection.h"
#include "client/sdk/earlier_servers.h"
#include "client/sdk/security.h"
#include "program/log/request_id.h"

namespace graspdb::client {
namespace {

// Calls that may be repeated without further effect are retried when the connection breaks or is
// refused, with four attempts within about a second; the others are not, as it is unknown whether
// they were executed.
constexpr char kFrames[] =
    R"({"service": "graspdb.v1.RecognitionService", "method": "Recognize"},)";
constexpr char kOthers[] = R"(
    {"service": "graspdb.v1.RecognitionService", "method": "FindLookAlikes"},
    {"service": "graspdb.v1.BackupService", "method": "CreateBackup"},
    {"service": "graspdb.v1.BackupService", "method": "ListBackups"},
    {"service": "graspdb.v1.CatalogService", "method": "GetCatalogStatus"},
    {"service": "graspdb.v1.CatalogService", "method": "GetObject"},
    {"service": "graspdb.v1.CatalogService", "method": "ListObjects"},
    {"service": "graspdb.v1.CatalogService", "method": "GetStablePose"},
    {"service": "graspdb.v1.CatalogService", "method": "ListStablePoses"},
    {"service": "graspdb.v1.CatalogService", "method": "GetView"},
    {"service": "graspdb.v1.CatalogService", "method": "ListViews"},
    {"service": "graspdb.v1.CatalogService", "method": "ReportGraspOutcome"},
    {"service": "graspdb.v1.UploadService", "method": "GetUpload"},
    {"service": "graspdb.v1.UploadService", "method": "CommitUpload"},
    {"service": "graspdb.v1.UploadService", "method": "ListUploads"},
    {"service": "graspdb.v1.UploadService", "method": "ListUploadViews"},
    {"service": "graspdb.v1.ObjectHistoryService", "method": "ListDeletedObjects"},
    {"service": "graspdb.v1.ObjectHistoryService", "method": "GetDeletedObject"},
    {"service": "graspdb.v1.ObjectHistoryService", "method": "ListObjectRevisions"},
    {"service": "graspdb.v1.CellService", "method": "GetCell"},
    {"service": "graspdb.v1.CellService", "method": "ListCells"}],
  "retryPolicy": {"maxAttempts": 4, "initialBackoff": "0.15s", "maxBackoff": "1s",
                  "backoffMultiplier": 2, "retryableStatusCodes": ["UNAVAILABLE"]}}]})";
// Buffer of a call for its retries, bytes; the largest frames fit.
constexpr int kRetryBuffer = 256 << 20;

// A channel on which every call fails, if the options cannot be used.
std::shared_ptr<grpc::Channel> Connect(const ConnectionOptions& options, bool usable) {
  if (!usable) return grpc::CreateChannel("", nullptr);
  grpc::ChannelArguments arguments = ChannelArgumentsFor(options.server);
  if (options.retry) {
    arguments.SetServiceConfigJSON(absl::StrCat(R"({"methodConfig": [{"name": [)",
                                                options.retry_frames ? kFrames : "", kOthers));
  }
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, options.retry ? 1 : 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, options.own_connection ? 1 : 0);
  arguments.SetInt(GRPC_ARG_PER_RPC_RETRY_BUFFER_SIZE, kRetryBuffer);
  return grpc::experimental::CreateCustomChannelWithInterceptors(
      options.server, MakeCredentials(options.security), arguments, MakeTokenInterceptors(options));
}

}  // namespace

Client::Client(const ConnectionOptions& options) : Client(options, CheckOptions(options)) {}
Client::Client(const ConnectionOptions& options, const absl::Status& usable) : options_(options) {
  auto tls_files = usable.ok() ? WatchTlsFiles(options.security) : nullptr;
  const std::shared_ptr<grpc::Channel> channel = Connect(options, usable.ok());
  stubs_ = std::make_unique<Stubs>(channel);
  stubs_->usable = usable;
  if (usable.ok()) stubs_->reconnection = std::make_unique<Reconnection>(channel);
  stubs_->tls_files = std::move(tls_files);
}
Client::Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options)
    : options_(std::move(options)), stubs_(std::make_unique<Stubs>(channel)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;

void Client::StopRetries() { stubs_->stopped.Raise(); }

std::string RequestIdOf(const absl::Status& status) {
  return std::string(status.GetPayload(kRequestIdKey).value_or(absl::Cord()));
}

absl::Status Client::ToStatus(const grpc::Status& status,
                              const grpc::ClientContext& context) const {
  if (!status.ok() && !stubs_->usable.ok()) return stubs_->usable;
  absl::Status out = Explain(status, options_);
  if ((absl::IsUnavailable(out) || absl::IsDeadlineExceeded(out)) &&
      stubs_->reconnection != nullptr && !stubs_->reconnection->IsConnected()) {
    stubs_->reconnection->Begin();
    // No attempt to connect has ended in the call's time: the server is unreachable and not slow.
    if (absl::IsDeadlineExceeded(out)) {
      out =
          Explain({grpc::StatusCode::UNAVAILABLE, "no answer to the attempt to connect"}, options_);
    }
  }
  const auto& trailing = context.GetServerTrailingMetadata();
  const auto id = trailing.find(kRequestIdKey);
  if (!out.ok() && id != trailing.end()) {
    out.SetPayload(kRequestIdKey,
                   absl::Cord(absl::string_view(id->second.data(), id->second.size())));
  }
  return out;
}

absl::StatusOr<v1::RecognizeResponse> Client::Recognize(const v1::RecognizeRequest& request) {
  return Recognize(request, options_.timeout);
}

absl::StatusOr<v1::RecognizeResponse> Client::Recognize(const v1::RecognizeRequest& request,
                                                        absl::Duration timeout,
                                                        const std::string& request_id) {
  ASSIGN_OR_RETURN(v1::RecognizeResponse response,
                   Call(*stubs_->recognition, &v1::RecognitionService::Stub::Recognize, request,
                        {timeout, request_id, options_.retry_frames}));
  FillGrasps(&response);
  return response;
}

absl::StatusOr<v1::FindLookAlikesResponse> Client::FindLookAlikes(const std::string& object) {
  v1::FindLookAlikesRequest request;
  request.set_object(object);
  return Call(*stubs_->recognition, &v1::RecognitionService::Stub::FindLookAlikes, request);
}

absl::StatusOr<v1::ProposeThresholdsResponse> Client::ProposeThresholds(
    const std::string& object, const OnProgress& on_progress) {
  v1::ProposeThresholdsRequest request;
  request.set_object(object);
  grpc::ClientContext context;
  return LastMessage<v1::ProposeThresholdsResponse>(
      context, stubs_->recognition->ProposeThresholds(&context, request), on_progress);
}

absl::Status Client::WatchCatalog(const v1::WatchCatalogRequest& request,
                                  const OnChange& on_change) {
  grpc::ClientContext context;
  return LastMessage<v1::WatchCatalogResponse>(
             context, stubs_->changes->WatchCatalog(&context, request), on_change)
      .status();
}

}  // namespace graspdb::client
