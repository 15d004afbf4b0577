// The client library: the services of a graspdb server as functions.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"

namespace grpc {
class Channel;
class Status;
}  // namespace grpc

namespace graspdb::client {

// How to connect to a server.
struct ConnectionOptions {
  std::string server = "127.0.0.1:50051";      // HOST:PORT
  absl::Duration timeout = absl::Seconds(30);  // of every call, but not of uploads
  // Whether read-only calls are retried after the connection is lost.
  bool retry = true;
  // Whether this client has its own connection; by default, clients of one server share one.
  bool own_connection = false;
};

// A connection to a server. Connects with the first call and reconnects when the connection is
// lost; read-only calls are then retried unless the options disable it. Thread-safe.
//
// All methods return the server's error, with its text; UNAVAILABLE, with advice in the text, when
// no server can be reached.
class Client {
 public:
  explicit Client(const ConnectionOptions& options);
  // Over an existing channel, e.g. inside a process.
  Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options);
  ~Client();
  Client(Client&&) noexcept;

  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request);
  // With its own time limit.
  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request,
                                                  absl::Duration timeout);

  // For the object with this resource name; for all objects if "".
  absl::StatusOr<v1::FindLookAlikesResponse> FindLookAlikes(const std::string& object);

  // For the stable poses of the object with this resource name; for all objects if "". Has no time
  // limit; `on_progress` receives the progress, and cancels the call by returning an error, which
  // is then returned.
  using OnProgress = std::function<absl::Status(const v1::ProposeThresholdsResponse&)>;
  absl::StatusOr<v1::ProposeThresholdsResponse> ProposeThresholds(const std::string& object,
                                                                  const OnProgress& on_progress);

  absl::StatusOr<v1::CatalogStatus> GetCatalogStatus();
  absl::StatusOr<v1::Object> CreateObject(const v1::CreateObjectRequest& request);
  absl::StatusOr<v1::Object> GetObject(const std::string& name);
  absl::StatusOr<v1::Object> UpdateObject(const v1::UpdateObjectRequest& request);
  absl::Status DeleteObject(const std::string& name, bool force);
  absl::StatusOr<v1::StablePose> CreateStablePose(const v1::CreateStablePoseRequest& request);
  absl::StatusOr<v1::StablePose> GetStablePose(const std::string& name);
  absl::StatusOr<v1::StablePose> UpdateStablePose(const v1::UpdateStablePoseRequest& request);
  // Never retried: after an error, the outcome may have been counted all the same.
  absl::StatusOr<v1::ReportGraspOutcomeResponse> ReportGraspOutcome(
      const v1::ReportGraspOutcomeRequest& request);
  // The view with its cloud.
  absl::StatusOr<v1::View> GetView(const std::string& name);
  absl::Status DeleteView(const std::string& name);

  // All of them, page by page.
  absl::StatusOr<std::vector<v1::Object>> ListObjects();
  absl::StatusOr<std::vector<v1::StablePose>> ListStablePoses(const std::string& object);
  absl::StatusOr<std::vector<v1::View>> ListViews(const std::string& stable_pose);

  // Sends views until `next` returns false (none left) or an error, which ends the upload and is
  // returned. Views that were sent before an error may have been taught.
  using NextView = std::function<absl::StatusOr<bool>(v1::UploadViewsRequest*)>;
  absl::StatusOr<v1::UploadViewsResponse> UploadViews(const NextView& next);

  absl::StatusOr<v1::Cell> CreateCell(const v1::CreateCellRequest& request);
  absl::StatusOr<v1::Cell> GetCell(const std::string& name);
  absl::StatusOr<v1::Cell> UpdateCell(const v1::UpdateCellRequest& request);
  absl::Status DeleteCell(const std::string& name);
  absl::StatusOr<std::vector<v1::Cell>> ListCells();

 private:
  struct Stubs;
  absl::Status ToStatus(const grpc::Status& status) const;
  template <typename Response, typename Stub, typename Method, typename Request>
  absl::StatusOr<Response> Call(Stub& stub, Method method, const Request& request) const {
    return Call<Response>(stub, method, request, options_.timeout);
  }
  template <typename Response, typename Stub, typename Method, typename Request>
  absl::StatusOr<Response> Call(Stub& stub, Method method, const Request& request,
                                absl::Duration timeout) const;

  ConnectionOptions options_;
  std::unique_ptr<Stubs> stubs_;
};

}  // namespace graspdb::client
