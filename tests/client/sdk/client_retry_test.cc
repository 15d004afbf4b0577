// Retries after a broken connection.
#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>

#include <atomic>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "program/base/uuid.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::IsOk;
using testing::StatusIs;

// Fails the first calls.
class Shaky : public v1::CatalogService::Service {
 public:
  explicit Shaky(int broken) : broken_(broken) {}
  grpc::Status GetCatalogStatus(grpc::ServerContext*, const v1::GetCatalogStatusRequest*,
                                v1::CatalogStatus* out) override {
    out->set_view_count(7);
    return Next();
  }
  grpc::Status CreateObject(grpc::ServerContext*, const v1::CreateObjectRequest*,
                            v1::Object*) override {
    return Next();
  }
  grpc::Status ReportGraspOutcome(grpc::ServerContext*,
                                  const v1::ReportGraspOutcomeRequest* request,
                                  v1::ReportGraspOutcomeResponse*) override {
    const absl::MutexLock lock(&mutex_);
    ids_.push_back(request->request_id());
    return Next();
  }
  grpc::Status DeleteObject(grpc::ServerContext*, const v1::DeleteObjectRequest*,
                            google::protobuf::Empty*) override {
    return {grpc::StatusCode::NOT_FOUND, "no such object", "details"};
  }
  int calls() const { return calls_; }
  // Of the reports.
  std::vector<std::string> ids() const {
    const absl::MutexLock lock(&mutex_);
    return ids_;
  }

 private:
  grpc::Status Next() {
    if (++calls_ > broken_) return grpc::Status::OK;
    return {grpc::StatusCode::UNAVAILABLE, "gone"};
  }

  const int broken_;
  std::atomic<int> calls_ = 0;
  mutable absl::Mutex mutex_;
  std::vector<std::string> ids_ ABSL_GUARDED_BY(mutex_);
};

class ClientRetryTest : public ::testing::Test {
 protected:
  Client Connect(Shaky& service, bool retry = true) {
    int port = 0;
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port);
    builder.RegisterService(&service);
    server_ = builder.BuildAndStart();
    return Client(ConnectionOptions{.server = absl::StrCat("127.0.0.1:", port), .retry = retry});
  }

  std::unique_ptr<grpc::Server> server_;
};

TEST_F(ClientRetryTest, ErrorsKeepTheirDetails) {
  Shaky service(0);
  const absl::Status status = Connect(service).DeleteObject("objects/mug", false);
  EXPECT_THAT(status, StatusIs(absl::StatusCode::kNotFound, "no such object"));
  EXPECT_EQ(status.GetPayload(kErrorDetails), "details");
}

TEST_F(ClientRetryTest, AReadOnlyCallIsRetried) {
  Shaky service(2);
  const auto status = Connect(service).GetCatalogStatus();
  ASSERT_THAT(status, IsOk());
  EXPECT_EQ(status->view_count(), 7);
  EXPECT_EQ(service.calls(), 3);
}

TEST_F(ClientRetryTest, AMutatingCallIsNotRetried) {
  Shaky service(1);
  EXPECT_THAT(Connect(service).CreateObject({}), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(service.calls(), 1);
}

TEST_F(ClientRetryTest, AReportIsRetriedWithItsId) {
  Shaky service(2);
  Client client = Connect(service);
  ASSERT_THAT(client.ReportGraspOutcome({}), IsOk());
  ASSERT_THAT(client.ReportGraspOutcome({}), IsOk());
  v1::ReportGraspOutcomeRequest own;
  own.set_request_id("mine");
  ASSERT_THAT(client.ReportGraspOutcome(own), IsOk());
  const std::vector<std::string> ids = service.ids();
  ASSERT_EQ(ids.size(), 5U);
  EXPECT_TRUE(IsUuid4(ids[0])) << ids[0];
  EXPECT_EQ(ids[1], ids[0]);
  EXPECT_EQ(ids[2], ids[0]);
  EXPECT_TRUE(IsUuid4(ids[3])) << ids[3];
  EXPECT_NE(ids[3], ids[0]);
  EXPECT_EQ(ids[4], "mine");
}

TEST_F(ClientRetryTest, NoCallIsRetriedIfRetriesAreDisabled) {
  Shaky service(1);
  EXPECT_THAT(Connect(service, /*retry=*/false).GetCatalogStatus(),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_EQ(service.calls(), 1);
}

TEST_F(ClientRetryTest, TheLastErrorHasTheReason) {
  Shaky service(1000);
  const auto status = Connect(service).GetCatalogStatus();
  ASSERT_THAT(status, StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(std::string(status.status().message()), ::testing::HasSubstr("(gone)"));
  EXPECT_EQ(service.calls(), 4);
}

}  // namespace
}  // namespace graspdb::client
