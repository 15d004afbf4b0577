// The client library: the services of a graspdb server as functions.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "graspdb/v1/backup_service.pb.h"
#include "graspdb/v1/catalog_service.pb.h"
#include "graspdb/v1/cell_service.pb.h"
#include "graspdb/v1/change_service.pb.h"
#include "graspdb/v1/object_history_service.pb.h"
#include "graspdb/v1/recognition_service.pb.h"
#include "graspdb/v1/upload_service.pb.h"

namespace grpc {
class Channel;
class ClientContext;
class Status;
template <typename R>
class ClientReader;
}  // namespace grpc

namespace graspdb::client {

// Encryption and identity. Files are read again when they change; the first three have PEM format,
// and each of them enables TLS. Those three stay in use as they were until the changed ones are
// complete and fit each other, and take two file descriptors until the process ends.
struct SecurityOptions {
  std::string ca = {};    // authorities that sign the server's certificate; empty: the system's
  std::string cert = {};  // certificate of this client, with its `key`
  std::string key = {};   // without a passphrase
  std::string token_file =
      {};  // a token in the first line; not sent to another machine without TLS
};

// How to connect to a server.
struct ConnectionOptions {
  std::string server = "127.0.0.1:50051";      // HOST:PORT
  absl::Duration timeout = absl::Seconds(30);  // of every call, but not of uploads
  // Whether calls are retried, within their time limit: those that may be repeated without further
  // effect after the connection is lost (UNAVAILABLE), up to four attempts with pauses of about a
  // second together; all but streams while the server is busy (RESOURCE_EXHAUSTED with a RetryInfo:
  // it has not begun the call).
  bool retry = true;
  // Whether Recognize is among them; not where the caller takes a new frame for each attempt.
  bool retry_frames = true;
  // How often a call is sent again while the server is busy, after the delay in its error (0.1 s)
  // and a random part of a span, which doubles from 0.1 to 1 s. Seven take about 3 s: a full queue,
  // of one frame a worker, is empty after some 0.1 s, so that 3 s mean a lasting overload, which
  // the caller should know.
  int busy_retries = 7;
  // Whether this client has its own connection; by default, clients of one server share one.
  bool own_connection = false;
  SecurityOptions security = {};
};

// Payload of a server's error (absl::Status::GetPayload): the serialized google.rpc.Status with its
// details, such as ErrorInfo, BadRequest and RetryInfo (docs/errors.md).
inline constexpr char kErrorDetails[] = "type.googleapis.com/google.rpc.Status";

// The id of the call that failed with this status, which is in the server's log; empty if the
// server was not reached.
std::string RequestIdOf(const absl::Status& status);

// A connection to a server. Connects with the first call, for which it waits up to 4 s; calls are
// retried as the options say. When a call has failed without a connection, a thread connects again,
// until that succeeds: about a second after the server is back. Thread-safe.
//
// All methods return the server's error, with its text and kErrorDetails; UNAVAILABLE, with advice
// in the text, when no server can be reached. Options that cannot be used are found by the
// constructor, and the error of every call: INVALID_ARGUMENT for a `server` without port, and for
// `cert` without `key` or reversed; FAILED_PRECONDITION for files of TLS that are folders or empty,
// and for a file without token.
class Client {
 public:
  explicit Client(const ConnectionOptions& options);
  // Over an existing channel, e.g. inside a process.
  Client(const std::shared_ptr<grpc::Channel>& channel, ConnectionOptions options);
  ~Client();
  Client(Client&&) noexcept;

  // From now on calls do not wait for a busy server but return its error; those that wait return it
  // at once.
  void StopRetries();

  // How often a call is sent again while the server is busy, by the options; for callers that
  // repeat their streams.
  int busy_retries() const { return options_.retry ? options_.busy_retries : 0; }

  // Each proposal has its `grasp`; it is made of the deprecated fields where the server does not
  // send it yet.
  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request);
  // With its own time limit. `request_id`, of 1 to 64 letters, digits, '-', '_' and '.', is sent as
  // the call's id (metadata x-request-id); if empty, the server chooses one.
  absl::StatusOr<v1::RecognizeResponse> Recognize(const v1::RecognizeRequest& request,
                                                  absl::Duration timeout,
                                                  const std::string& request_id = "");

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
  // Counted once, however often it is retried: the request gets a `request_id` if it has none.
  // After an error it is not known whether it was counted; call it again with the same id of your
  // own.
  absl::StatusOr<v1::ReportGraspOutcomeResponse> ReportGraspOutcome(
      const v1::ReportGraspOutcomeRequest& request);
  // The view with its cloud.
  absl::StatusOr<v1::View> GetView(const std::string& name);
  absl::Status DeleteView(const std::string& name);

  // All of them, page by page.
  absl::StatusOr<std::vector<v1::Object>> ListObjects();
  absl::StatusOr<std::vector<v1::StablePose>> ListStablePoses(const std::string& object);
  absl::StatusOr<std::vector<v1::View>> ListViews(const std::string& stable_pose);

  // Deleted objects and earlier revisions of objects, all of them.
  absl::StatusOr<std::vector<v1::Object>> ListDeletedObjects();
  absl::StatusOr<v1::Object> GetDeletedObject(const std::string& name);
  absl::StatusOr<v1::Object> UndeleteObject(const std::string& name);
  absl::Status PurgeObject(const std::string& name);
  absl::StatusOr<std::vector<v1::ObjectRevision>> ListObjectRevisions(const std::string& object);
  absl::StatusOr<v1::Object> RestoreObject(const v1::RestoreObjectRequest& request);

  // Sends views until `next` returns false (none left) or an error, which ends the upload and is
  // returned. Views that were sent before an error may have been taught.
  using NextView = std::function<absl::StatusOr<bool>(v1::UploadViewsRequest*)>;
  absl::StatusOr<v1::UploadViewsResponse> UploadViews(const NextView& next);

  // Bulk uploads: views that become part of the catalogue together.
  absl::StatusOr<v1::Upload> CreateUpload(const v1::CreateUploadRequest& request);
  absl::StatusOr<v1::Upload> GetUpload(const std::string& name);
  absl::StatusOr<std::vector<v1::Upload>> ListUploads();
  absl::StatusOr<std::vector<v1::UploadView>> ListUploadViews(const std::string& upload);
  // Has no time limit. May be repeated after an error.
  absl::StatusOr<v1::Upload> CommitUpload(const v1::CommitUploadRequest& request);
  absl::Status DeleteUpload(const std::string& name);
  // Sends views over one stream until `next` returns false or an error, which is then returned.
  // `done` gets the response to each, in order; it is called between the calls of `next`. Views
  // without a response when the stream fails must be sent again, which repeats no work: those that
  // are staged already are not computed again. Not repeated itself while the server is busy.
  using NextUploadView = std::function<absl::StatusOr<bool>(v1::WriteUploadViewsRequest*)>;
  using UploadViewDone = std::function<void(const v1::WriteUploadViewsResponse&)>;
  absl::Status WriteUploadViews(const NextUploadView& next, const UploadViewDone& done);

  // Gets the changes of the catalogue until the server ends the call or `on_change` returns an
  // error, which is then returned. Has no time limit. To continue, send revision and id of the last
  // response that was not `continued`; OUT_OF_RANGE: all records must be read anew.
  using OnChange = std::function<absl::Status(const v1::WatchCatalogResponse&)>;
  absl::Status WatchCatalog(const v1::WatchCatalogRequest& request, const OnChange& on_change);

  absl::StatusOr<v1::Cell> CreateCell(const v1::CreateCellRequest& request);
  // Within `timeout`, by default that of the options.
  absl::StatusOr<v1::Cell> GetCell(const std::string& name,
                                   std::optional<absl::Duration> timeout = std::nullopt);
  absl::StatusOr<v1::Cell> UpdateCell(const v1::UpdateCellRequest& request);
  absl::Status DeleteCell(const std::string& name);
  absl::StatusOr<std::vector<v1::Cell>> ListCells();

  // Create, verify and compare have no time limit: the callback receives the progress, several
  // times a second, and cancels the call by returning an error, which is then returned. Names are
  // "backups/7".
  using OnBytes = std::function<absl::Status(std::int64_t done_byte_count)>;
  using OnDifferences = std::function<absl::Status(const v1::CompareBackupResponse&)>;
  absl::StatusOr<v1::Backup> CreateBackup(const OnBytes& on_bytes);
  absl::StatusOr<v1::Backup> VerifyBackup(const std::string& name, const OnBytes& on_bytes);
  absl::StatusOr<v1::Backup> CompareBackup(const std::string& name, const OnDifferences& on_some);
  absl::StatusOr<std::vector<v1::Backup>> ListBackups();
  absl::Status DeleteBackup(const std::string& name);

 private:
  struct Stubs;
  struct CallSettings {
    absl::Duration timeout;
    std::string request_id = {};  // empty: the server's
    bool retry = true;            // unless the options disable it
  };
  // `usable`: whether the options can be used.
  Client(const ConnectionOptions& options, const absl::Status& usable);
  // `context` is that of the call, which has ended.
  absl::Status ToStatus(const grpc::Status& status, const grpc::ClientContext& context) const;
  template <typename Stub, typename Request, typename Response>
  using Method = grpc::Status (Stub::*)(grpc::ClientContext*, const Request&, Response*);
  template <typename Stub, typename Request, typename Response>
  absl::StatusOr<Response> Call(Stub& stub, Method<Stub, Request, Response> method,
                                const Request& request, const CallSettings& settings) const;
  template <typename Stub, typename Request, typename Response>
  absl::StatusOr<Response> Call(Stub& stub, Method<Stub, Request, Response> method,
                                const Request& request) const {
    return Call(stub, method, request, {.timeout = options_.timeout});
  }
  // A call without retries.
  template <typename Stub, typename Request, typename Response>
  absl::StatusOr<Response> Attempt(Stub& stub, Method<Stub, Request, Response> method,
                                   const Request& request, absl::Duration timeout,
                                   const std::string& request_id) const;
  // Reads a stream; `on_message` receives every message and can cancel the call by an error.
  template <typename Response, typename OnMessage>
  absl::StatusOr<Response> LastMessage(grpc::ClientContext& context,
                                       std::unique_ptr<grpc::ClientReader<Response>> reader,
                                       const OnMessage& on_message) const;
  // All pages of a list; `records` are those of a page.
  template <typename Stub, typename Request, typename Response, typename Record>
  absl::StatusOr<std::vector<Record>> ListAll(
      Stub& stub, Method<Stub, Request, Response> method, Request request,
      google::protobuf::RepeatedPtrField<Record>* (Response::*records)()) const;

  ConnectionOptions options_;
  std::unique_ptr<Stubs> stubs_;
};

}  // namespace graspdb::client
