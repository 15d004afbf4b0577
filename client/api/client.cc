#include "client/api/client.h"

#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>

#include <utility>

#include "absl/strings/str_cat.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"

namespace graspdb::client {
namespace {

// Calls that change nothing are made again when the connection breaks or was refused, four
// times within about a second; of the others nobody would know whether they had been done.
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
// What is kept of a call to make it again, bytes; the largest frames fit.
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

// Lists all pages: `list(token)` gives one, `take(page)` keeps its records.
template <typename List, typename Take>
absl::Status ForEachPage(List&& list, Take&& take) {
  std::string token;
  do {
    auto page = list(token);
    if (!page.ok()) return page.status();
    token = page->next_page_token();
    take(*std::move(page));
  } while (!token.empty());
  return absl::OkStatus();
}

template <typename Record, typename Field>
void Append(Field& field, std::vector<Record>* out) {
  for (auto& record : field) out->push_back(std::move(record));
}

}  // namespace

struct Client::Stubs {
  explicit Stubs(const std::shared_ptr<grpc::Channel>& channel)
      : catalog(v1::CatalogService::NewStub(channel)),
        cells(v1::CellService::NewStub(channel)),
        recognition(v1::RecognitionService::NewStub(channel)) {}
  std::unique_ptr<v1::CatalogService::Stub> catalog;
  std::unique_ptr<v1::CellService::Stub> cells;
  std::unique_ptr<v1::RecognitionService::Stub> recognition;
};

using Catalog = v1::CatalogService::Stub;
using Cells = v1::CellService::Stub;

Client::Client(const ConnectionOptions& options) : Client(Connect(options), options) {}
Client::Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options)
    : options_(std::move(options)), stubs_(std::make_unique<Stubs>(channel)) {}
Client::~Client() = default;
Client::Client(Client&&) noexcept = default;

absl::Status Client::ToStatus(const grpc::Status& status) const {
  if (status.ok()) return absl::OkStatus();
  // gRPC's own UNAVAILABLE speaks of sockets; the server's never has no details.
  if (status.error_code() == grpc::StatusCode::UNAVAILABLE && status.error_details().empty()) {
    return absl::UnavailableError(absl::StrCat(
        "no graspdb server answers at ", options_.server,
        "; start graspdb-server or give --server HOST:PORT (", status.error_message(), ")"));
  }
  return {static_cast<absl::StatusCode>(status.error_code()), status.error_message()};
}

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

absl::StatusOr<v1::ProposeThresholdsResponse> Client::ProposeThresholds(const std::string& object,
                                                                        const HearProgress& heard) {
  v1::ProposeThresholdsRequest request;
  request.set_object(object);
  grpc::ClientContext context;
  const auto reader = stubs_->recognition->ProposeThresholds(&context, request);
  v1::ProposeThresholdsResponse message;
  while (reader->Read(&message)) {
    absl::Status status = heard(message);
    if (status.ok()) continue;
    context.TryCancel();
    (void)reader->Finish();  // cancelled by us; the caller's error says why
    return status;
  }
  const grpc::Status status = reader->Finish();
  if (!status.ok()) return ToStatus(status);
  return message;
}

absl::StatusOr<v1::CatalogStatus> Client::GetCatalogStatus() {
  return Call<v1::CatalogStatus>(*stubs_->catalog, &Catalog::GetCatalogStatus,
                                 v1::GetCatalogStatusRequest());
}

absl::StatusOr<v1::Object> Client::CreateObject(const v1::CreateObjectRequest& request) {
  return Call<v1::Object>(*stubs_->catalog, &Catalog::CreateObject, request);
}

absl::StatusOr<v1::Object> Client::GetObject(const std::string& name) {
  v1::GetObjectRequest request;
  request.set_name(name);
  return Call<v1::Object>(*stubs_->catalog, &Catalog::GetObject, request);
}

absl::StatusOr<v1::Object> Client::UpdateObject(const v1::UpdateObjectRequest& request) {
  return Call<v1::Object>(*stubs_->catalog, &Catalog::UpdateObject, request);
}

absl::Status Client::DeleteObject(const std::string& name, bool force) {
  v1::DeleteObjectRequest request;
  request.set_name(name);
  request.set_force(force);
  return Call<google::protobuf::Empty>(*stubs_->catalog, &Catalog::DeleteObject, request).status();
}

absl::StatusOr<v1::StablePose> Client::CreateStablePose(
    const v1::CreateStablePoseRequest& request) {
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::CreateStablePose, request);
}

absl::StatusOr<v1::StablePose> Client::UpdateStablePose(
    const v1::UpdateStablePoseRequest& request) {
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::UpdateStablePose, request);
}

absl::StatusOr<v1::StablePose> Client::GetStablePose(const std::string& name) {
  v1::GetStablePoseRequest request;
  request.set_name(name);
  return Call<v1::StablePose>(*stubs_->catalog, &Catalog::GetStablePose, request);
}

absl::StatusOr<v1::View> Client::GetView(const std::string& name) {
  v1::GetViewRequest request;
  request.set_name(name);
  request.set_detail(v1::VIEW_DETAIL_FULL);
  return Call<v1::View>(*stubs_->catalog, &Catalog::GetView, request);
}

absl::Status Client::DeleteView(const std::string& name) {
  v1::DeleteViewRequest request;
  request.set_name(name);
  return Call<google::protobuf::Empty>(*stubs_->catalog, &Catalog::DeleteView, request).status();
}

absl::StatusOr<std::vector<v1::Object>> Client::ListObjects() {
  std::vector<v1::Object> out;
  v1::ListObjectsRequest request;
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListObjectsResponse>(*stubs_->catalog, &Catalog::ListObjects, request);
      },
      [&](v1::ListObjectsResponse page) { Append(*page.mutable_objects(), &out); });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<std::vector<v1::StablePose>> Client::ListStablePoses(const std::string& object) {
  std::vector<v1::StablePose> out;
  v1::ListStablePosesRequest request;
  request.set_parent(object);
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListStablePosesResponse>(*stubs_->catalog, &Catalog::ListStablePoses,
                                                 request);
      },
      [&](v1::ListStablePosesResponse page) { Append(*page.mutable_stable_poses(), &out); });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<std::vector<v1::View>> Client::ListViews(const std::string& stable_pose) {
  std::vector<v1::View> out;
  v1::ListViewsRequest request;
  request.set_parent(stable_pose);
  request.set_page_size(1000);
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListViewsResponse>(*stubs_->catalog, &Catalog::ListViews, request);
      },
      [&](v1::ListViewsResponse page) { Append(*page.mutable_views(), &out); });
  if (!status.ok()) return status;
  return out;
}

absl::StatusOr<v1::UploadViewsResponse> Client::UploadViews(const NextView& next) {
  grpc::ClientContext context;
  v1::UploadViewsResponse response;
  auto writer = stubs_->catalog->UploadViews(&context, &response);
  v1::UploadViewsRequest request;
  for (;;) {
    absl::StatusOr<bool> more = next(&request);
    if (!more.ok()) {
      context.TryCancel();
      (void)writer->Finish();  // cancelled by us; the caller's error says why
      return more.status();
    }
    if (!*more || !writer->Write(request)) break;
  }
  writer->WritesDone();
  const grpc::Status status = writer->Finish();
  if (!status.ok()) return ToStatus(status);
  return response;
}

absl::StatusOr<v1::Cell> Client::CreateCell(const v1::CreateCellRequest& request) {
  return Call<v1::Cell>(*stubs_->cells, &Cells::CreateCell, request);
}

absl::StatusOr<v1::Cell> Client::GetCell(const std::string& name) {
  v1::GetCellRequest request;
  request.set_name(name);
  return Call<v1::Cell>(*stubs_->cells, &Cells::GetCell, request);
}

absl::StatusOr<v1::Cell> Client::UpdateCell(const v1::UpdateCellRequest& request) {
  return Call<v1::Cell>(*stubs_->cells, &Cells::UpdateCell, request);
}

absl::Status Client::DeleteCell(const std::string& name) {
  v1::DeleteCellRequest request;
  request.set_name(name);
  return Call<google::protobuf::Empty>(*stubs_->cells, &Cells::DeleteCell, request).status();
}

absl::StatusOr<std::vector<v1::Cell>> Client::ListCells() {
  std::vector<v1::Cell> out;
  v1::ListCellsRequest request;
  absl::Status status = ForEachPage(
      [&](const std::string& token) {
        request.set_page_token(token);
        return Call<v1::ListCellsResponse>(*stubs_->cells, &Cells::ListCells, request);
      },
      [&](v1::ListCellsResponse page) { Append(*page.mutable_cells(), &out); });
  if (!status.ok()) return status;
  return out;
}

}  // namespace graspdb::client
