#include "client/sdk/client.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "client/sdk/client_call.h"

namespace graspdb::client {
namespace {

// Read-only calls are retried when the connection breaks or is refused, with four attempts within
// about a second; the others are not, as it is unknown whether they were executed.
constexpr char kRetries[] = R"({"methodConfig": [{
  "name": [
    {"service": "graspdb.v1.RecognitionService", "method": "Recognize"},
    {"service": "graspdb.v1.RecognitionService", "method": "FindLookAlikes"},
    {"service": "graspdb.v1.CatalogService", "method": "GetCatalogStatus"},
    {"service": "graspdb.v1.CatalogService", "method": "GetObject"},
    {"service": "graspdb.v1.CatalogService", "method": "ListObjects"},
    {"service": "graspdb.v1.CatalogService", "method": "GetStablePose"},
    {"service": "graspdb.v1.CatalogService", "method": "ListStablePoses"},
    {"service": "graspdb.v1.CatalogService", "method": "GetView"},
    {"service": "graspdb.v1.CatalogService", "method": "ListViews"},
    {"service": "graspdb.v1.CellService", "method": "GetCell"},
    {"service": "graspdb.v1.CellService", "method": "ListCells"}],
  "retryPolicy": {"maxAttempts": 4, "initialBackoff": "0.15s", "maxBackoff": "1s",
                  "backoffMultiplier": 2, "retryableStatusCodes": ["UNAVAILABLE"]}}]})";
constexpr int kReconnectMs = 100;
// Buffer of a call for its retries, bytes; the largest frames fit.
constexpr int kRetryBuffer = 256 << 20;

std::shared_ptr<grpc::Channel> Connect(const ConnectionOptions& options) {
  grpc::ChannelArguments arguments;
  if (options.retry) arguments.SetServiceConfigJSON(kRetries);
  arguments.SetInt(GRPC_ARG_ENABLE_RETRIES, options.retry ? 1 : 0);
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, options.own_connection ? 1 : 0);
  arguments.SetInt(GRPC_ARG_INITIAL_RECONNECT_BACKOFF_MS, kReconnectMs);
  arguments.SetInt(GRPC_ARG_MIN_RECONNECT_BACKOFF_MS, kReconnectMs);
  arguments.SetInt(GRPC_ARG_PER_RPC_RETRY_BUFFER_SIZE, kRetryBuffer);
  arguments.SetMaxReceiveMessageSize(-1);
  arguments.SetMaxSendMessageSize(-1);
  return grpc::CreateCustomChannel(options.server, grpc::InsecureChannelCredentials(), arguments);
}

}  // namespace

Client::Client(const ConnectionOptions& options) : Client(Connect(options), options) {}
Client::Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options)
    : options_(std::move(options)), stubs_(std::make_unique<Stubs>(channel)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;

absl::Status Client::ToStatus(const grpc::Status& status) const {
  if (status.ok()) return absl::OkStatus();
  // gRPC's own UNAVAILABLE describes sockets and has no details; the server's always has some.
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && status.error_details().empty()) {
    return absl::UnavailableError(absl::StrCat(
        "no graspdb server is reachable at ", options_.server,
        "; start graspdb-server or give --server HOST:PORT (", status.error_message(), ")"));
  }
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

absl::StatusOr<v1::RecognizeResponse> Client::Recognize(const v1::RecognizeRequest& request) {
  return Recognize(request, options_.timeout);
}

absl::StatusOr<v1::RecognizeResponse> Client::Recognize(const v1::RecognizeRequest& request,
                                                        absl::Duration timeout) {
  return Call<v1::RecognizeResponse>(*stubs_->recognition, &v1::RecognitionService::Stub::Recognize,
                                     request, timeout);
}

absl::StatusOr<v1::FindLookAlikesResponse> Client::FindLookAlikes(const std::string& object) {
  v1::FindLookAlikesRequest request;
  request.set_object(object);
  return Call<v1::FindLookAlikesResponse>(*stubs_->recognition,
                                          &v1::RecognitionService::Stub::FindLookAlikes, request);
}

absl::StatusOr<v1::ProposeThresholdsResponse> Client::ProposeThresholds(
    const std::string& object, const OnProgress& on_progress) {
  v1::ProposeThresholdsRequest request;
  request.set_object(object);
  grpc::ClientContext context;
  const auto reader = stubs_->recognition->ProposeThresholds(&context, request);
  v1::ProposeThresholdsResponse message;
  while (reader->Read(&message)) {
    absl::Status status = on_progress(message);
    if (status.ok()) continue;
    context.TryCancel();
    (void)reader->Finish();  // cancelled here; the caller's error has the reason
    return status;
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return ToStatus(status);
  return message;
}

}  // namespace graspdb::client
