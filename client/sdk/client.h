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

// How a server is reached.
struct ConnectionOptions {
  std::string server = "127.0.0.1:50051";      // HOST:PORT
  absl::Duration timeout = absl::Seconds(30);  // of every call, but not of uploads
  // Whether calls that change nothing are made again after a loss of the connection.
  bool retry = true;
  // Whether the connection is this client's alone; else clients of one server share one.
  bool own_connection = false;
};

// A connection to a server. Connects with the first call and again after a loss;
// a call that changes nothing outlives the loss, unless the options say otherwise. Thread-safe.
//
// All methods answer the server's error, with its text; UNAVAILABLE, with a text
// that says what to do, when no server can be reached.
class Client {
 public:
  explicit Client(const ConnectionOptions& options);
  // Over a channel that is there already, e.g. inside a process.
  Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options);
  ~Client();
  Client(Client&&) noexcept;

  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request);
  // With a time limit of its own.
  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request,
                                                  absl::Duration timeout);

  // Of the object of that resource name; of all for "".
  absl::StatusOr<v1::FindLookAlikesResponse> FindLookAlikes(const std::string& object);

  // Of the stable poses of the object of that resource name; of all for "". Takes as long as it
  // takes; `heard` is told how far it is, and stops it with an error, which is returned.
  using HearProgress = std::function<absl::Status(const v1::ProposeThresholdsResponse&)>;
  absl::StatusOr<v1::ProposeThresholdsResponse> ProposeThresholds(const std::string& object,
                                                                  const HearProgress& heard);

  absl::StatusOr<v1::CatalogStatus> GetCatalogStatus();
  absl::StatusOr<v1::Object> CreateObject(const v1::CreateObjectRequest& request);
  absl::StatusOr<v1::Object> GetObject(const std::string& name);
  absl::StatusOr<v1::Object> UpdateObject(const v1::UpdateObjectRequest& request);
  absl::Status DeleteObject(const std::string& name, bool force);
  absl::StatusOr<v1::StablePose> CreateStablePose(const v1::CreateStablePoseRequest& request);
  absl::StatusOr<v1::StablePose> GetStablePose(const std::string& name);
  absl::StatusOr<v1::StablePose> UpdateStablePose(const v1::UpdateStablePoseRequest& request);
  // Once, whatever becomes of the connection: an error may mean that it was counted.
  absl::StatusOr<v1::ReportGraspOutcomeResponse> ReportGraspOutcome(
      const v1::ReportGraspOutcomeRequest& request);
  // The view with its cloud.
  absl::StatusOr<v1::View> GetView(const std::string& name);
  absl::Status DeleteView(const std::string& name);

  // All of them, page by page.
  absl::StatusOr<std::vector<v1::Object>> ListObjects();
  absl::StatusOr<std::vector<v1::StablePose>> ListStablePoses(const std::string& object);
  absl::StatusOr<std::vector<v1::View>> ListViews(const std::string& stable_pose);

  // Sends views until `next` has none left (it then returns false) or fails; its
  // error ends the upload and is returned. Views that were sent before an error
  // may have been taught.
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
