#include "client/teaching/upload/bulk_upload.h"

#include <gmock/gmock.h>
#include <grpcpp/security/server_credentials.h>
#include <grpcpp/server_builder.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "tests/testing/busy_status.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::BusyFor;
using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::AllOf;
using ::testing::HasSubstr;

// Refuses streams of views, as a server whose memory is full. For streams of a few views: the
// client waits for answers before it sends more.
class BusyUploads : public v1::UploadService::Service {
 public:
  BusyUploads() {
    grpc::ServerBuilder builder;
    builder.AddListeningPort("127.0.0.1:0", grpc::InsecureServerCredentials(), &port_);
    builder.RegisterService(this);
    server_ = builder.BuildAndStart();
  }

  Client Connect(int busy_retries) const {
    return Client({.server = absl::StrCat("127.0.0.1:", port_), .busy_retries = busy_retries});
  }

  grpc::Status GetUpload(grpc::ServerContext*, const v1::GetUploadRequest*, v1::Upload*) override {
    return {grpc::StatusCode::NOT_FOUND, "no upload"};
  }
  grpc::Status CreateUpload(grpc::ServerContext*, const v1::CreateUploadRequest*,
                            v1::Upload*) override {
    return created;
  }
  grpc::Status WriteUploadViews(
      grpc::ServerContext*,
      grpc::ServerReaderWriter<v1::WriteUploadViewsResponse, v1::WriteUploadViewsRequest>* stream)
      override {
    // All first: a client that still writes when it is refused may not read the answers.
    std::vector<std::string> received;
    for (v1::WriteUploadViewsRequest request; stream->Read(&request);) {
      received.push_back(request.view().view_id());
    }
    absl::MutexLock lock(&mutex_);
    for (std::size_t i = 0; i < received.size(); ++i) {
      if (i == answers && refused_ < refusals) {
        ++refused_;
        return refusal.ok() ? BusyFor(delay) : refusal;
      }
      views_.insert(received[i]);
      stream->Write(v1::WriteUploadViewsResponse());
    }
    return grpc::Status::OK;
  }
  grpc::Status CommitUpload(grpc::ServerContext*, const v1::CommitUploadRequest*,
                            v1::Upload* response) override {
    if (!committed.ok()) return committed;
    absl::MutexLock lock(&mutex_);
    response->set_created_count(static_cast<std::int64_t>(views_.size()));
    return grpc::Status::OK;
  }

  int refused() const {
    absl::MutexLock lock(&mutex_);
    return refused_;
  }

  // The script. After the first call, do not change it.
  std::size_t answers = 0;  // of a stream before it is refused
  int refusals = 0;         // of all streams
  absl::Duration delay = absl::Milliseconds(1);
  grpc::Status refusal = grpc::Status::OK;  // of streams; OK: busy for `delay`
  grpc::Status created = grpc::Status::OK;
  grpc::Status committed = grpc::Status::OK;

 private:
  int port_ = 0;
  mutable absl::Mutex mutex_;
  int refused_ ABSL_GUARDED_BY(mutex_) = 0;
  std::set<std::string> views_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<grpc::Server> server_;
};

class BulkUploadTest : public ::testing::Test {
 protected:
  absl::StatusOr<BulkUploadResult> Teach(std::size_t count, int streams, int busy_retries,
                                         const UploadWatch& watch = {}) const {
    Client client = server_.Connect(busy_retries);
    const ViewsToTeach views = {.count = count,
                                .make =
                                    [](std::size_t i, v1::UploadViewsRequest* request) {
                                      request->set_parent("objects/mug/stablePoses/upright");
                                      request->set_view_id(absl::StrCat("turn-", i));
                                      return absl::OkStatus();
                                    },
                                .replace = true};
    return TeachInBulk(client, views, {.upload_id = "import-1", .streams = streams}, watch);
  }

  BusyUploads server_;
};

TEST_F(BulkUploadTest, ViewsThatABusyServerHasNotTakenAreSentAgain) {
  server_.refusals = 3;
  const auto taught = Teach(/*count=*/5, /*streams=*/4, /*busy_retries=*/7);
  ASSERT_THAT(taught, IsOk());
  EXPECT_EQ(taught->counts.created, 5);
  EXPECT_TRUE(taught->failed.empty());
  EXPECT_EQ(server_.refused(), 3);
}

TEST_F(BulkUploadTest, APlanCountsTheSameViewOnce) {
  Client client = server_.Connect(/*busy_retries=*/0);
  const ViewsToTeach views = {.count = 5,
                              .make =
                                  [](std::size_t i, v1::UploadViewsRequest* request) {
                                    request->set_parent("objects/mug/stablePoses/upright");
                                    request->set_view_id(absl::StrCat("turn-", i % 2));
                                    return absl::OkStatus();
                                  },
                              .replace = true};
  const auto plan = PlanUpload(client, views, "import-1", {});
  ASSERT_THAT(plan, IsOk());
  EXPECT_EQ(plan->new_count, 2U);
  EXPECT_EQ(plan->repeated_count, 3U);
}

TEST_F(BulkUploadTest, TheCountOfRetriesBeginsAgainWithEachViewThatTheServerTakes) {
  server_.answers = 1;
  server_.refusals = 1000;
  const auto taught = Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/1);
  ASSERT_THAT(taught, IsOk());
  EXPECT_EQ(taught->counts.created, 5);
  EXPECT_EQ(server_.refused(), 4);
}

TEST_F(BulkUploadTest, AServerThatStaysBusyEndsIt) {
  server_.refusals = 1000;
  EXPECT_THAT(Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/2),
              StatusIs(absl::StatusCode::kResourceExhausted, "the queue is full"));
  EXPECT_EQ(server_.refused(), 3);
}

TEST_F(BulkUploadTest, AnInterruptEndsTheWaitForABusyServer) {
  server_.refusals = 1000;
  server_.delay = absl::Seconds(25);
  int checks = 0;  // before the only view, after it, then during the wait
  const UploadWatch watch = {.report = nullptr, .cancelled = [&] { return ++checks > 2; }};
  EXPECT_THAT(Teach(/*count=*/1, /*streams=*/1, /*busy_retries=*/7, watch),
              StatusIs(absl::StatusCode::kCancelled, HasSubstr("interrupted after 0 of 1 views")));
  EXPECT_EQ(server_.refused(), 1);
}

TEST_F(BulkUploadTest, AnUploadThatAnotherProcessCreatedMeanwhileIsNamed) {
  server_.created = {grpc::StatusCode::ALREADY_EXISTS, "exists"};
  EXPECT_THAT(Teach(/*count=*/1, /*streams=*/1, /*busy_retries=*/0),
              StatusIs(absl::StatusCode::kAlreadyExists,
                       AllOf(HasSubstr("another import of the same views has just begun; wait"),
                             HasSubstr("graspdb uploads show import-1"))));
}

TEST_F(BulkUploadTest, AServerThatIsLostLeavesTheViewsThatWereSent) {
  server_.refusal = {grpc::StatusCode::UNAVAILABLE, "gone", "details"};
  server_.refusals = 1000;
  server_.answers = 2;
  const auto lost = Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/0);
  EXPECT_THAT(lost, StatusIs(absl::StatusCode::kUnavailable,
                             AllOf(HasSubstr("gone; the views sent are safe"),
                                   HasSubstr("run the same command with --resume to go on"))));
  EXPECT_EQ(lost.status().GetPayload(kErrorDetails), "details");
}

TEST_F(BulkUploadTest, ViewsOfAStreamThatGrpcResetAreSentAgain) {
  server_.refusal = {grpc::StatusCode::INTERNAL, "Received RST_STREAM with error code 1"};
  server_.refusals = 1000;
  server_.answers = 2;
  const auto taught = Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/0);
  ASSERT_THAT(taught, IsOk());
  EXPECT_EQ(taught->counts.created, 5);
  EXPECT_EQ(server_.refused(), 2);
}

TEST_F(BulkUploadTest, AStreamThatIsResetAgainWithoutAnAnswerEndsIt) {
  server_.refusal = {grpc::StatusCode::INTERNAL, "Received RST_STREAM with error code 1"};
  server_.refusals = 1000;
  EXPECT_THAT(Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/7),
              StatusIs(absl::StatusCode::kInternal, HasSubstr("RST_STREAM")));
  EXPECT_EQ(server_.refused(), 1);
}

// It may have been made, after which there is no upload to resume.
TEST_F(BulkUploadTest, ACommitThatIsLostNeedsNoResume) {
  server_.committed = {grpc::StatusCode::UNAVAILABLE, "gone", "details"};
  EXPECT_THAT(Teach(/*count=*/5, /*streams=*/1, /*busy_retries=*/0),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("run the same command to go on")));
}

}  // namespace
}  // namespace graspdb::client
