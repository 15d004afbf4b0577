// A server on a database of its own, and its stubs.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "graspdb/v1/backup_service.grpc.pb.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/cell_service.grpc.pb.h"
#include "graspdb/v1/object_history_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/server.h"
#include "tests/files/temporary_folder.h"
#include "tests/server/error_details.h"
#include "tests/server/sample_captures.h"

namespace graspdb::testing {

class ServerTest : public ::testing::Test {
 protected:
  using BackupStub = v1::BackupService::Stub;
  using Catalog = v1::CatalogService::Stub;
  using Cells = v1::CellService::Stub;
  using History = v1::ObjectHistoryService::Stub;
  using Recognition = v1::RecognitionService::Stub;

  void SetUp() override;

  // Starts the server with `options`, on the existing database.
  void Start();
  // Ends the server and starts it again.
  void Restart();

  // One call over the in-process channel.
  template <typename Stub, typename Request, typename Response>
  grpc::Status Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request, Response* response) {
    grpc::ClientContext context;
    if (!token_.empty()) context.AddMetadata("authorization", "Bearer " + token_);
    return (StubOf<Stub>().*method)(&context, request, response);
  }
  // The same, if only the status matters.
  template <typename Stub, typename Request, typename Response>
  grpc::Status Call(grpc::Status (Stub::*method)(grpc::ClientContext*, const Request&, Response*),
                    const Request& request) {
    Response ignored;
    return Call(method, request, &ignored);
  }

  v1::CatalogStatus Status();

  grpc::Status CreateObject(const std::string& id, v1::Object* made = nullptr);
  // Creates the part's object and its stable pose "flat", with the part's grasps.
  void Declare(const std::string& part);
  // Declares the part and teaches `views` views of it, evenly turned.
  void Teach(const std::string& part, int views);

  grpc::Status Upload(const std::vector<v1::UploadViewsRequest>& views,
                      v1::UploadViewsResponse* response);
  grpc::Status Upload(const v1::UploadViewsRequest& view);

  // The response to a valid request.
  v1::RecognizeResponse Answer(const v1::RecognizeRequest& request);

  const files::TemporaryFolder folder_;
  server::ServerOptions options_;
  std::unique_ptr<server::Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
  std::string token_;  // of the next calls

  template <typename Stub>
  Stub& StubOf();

 private:
  std::unique_ptr<BackupStub> backups_;
  std::unique_ptr<Catalog> catalog_;
  std::unique_ptr<Cells> cells_;
  std::unique_ptr<History> history_;
  std::unique_ptr<Recognition> recognition_;
};

template <>
inline ServerTest::BackupStub& ServerTest::StubOf() {
  return *backups_;
}
template <>
inline ServerTest::Catalog& ServerTest::StubOf() {
  return *catalog_;
}
template <>
inline ServerTest::Cells& ServerTest::StubOf() {
  return *cells_;
}
template <>
inline ServerTest::History& ServerTest::StubOf() {
  return *history_;
}
template <>
inline ServerTest::Recognition& ServerTest::StubOf() {
  return *recognition_;
}

// "objects/{part}/stablePoses/flat".
std::string FlatPoseOf(const std::string& part);

// The part at the origin, as in an upload.
v1::UploadViewsRequest ViewOf(const std::string& part, double turn_deg, const std::string& id);

// A frame with its sensor pose, timings left out.
v1::RecognizeRequest RequestOf(const Frame& frame);

}  // namespace graspdb::testing
