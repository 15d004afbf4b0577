// Commits of bulk uploads that are ended while they describe views.
#include <gmock/gmock.h>
#include <grpcpp/server.h>
#include <grpcpp/server_builder.h>
#include <spdlog/details/null_mutex.h>
#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "graspdb/v1/upload_service.grpc.pb.h"
#include "server/calls/admission.h"
#include "server/calls/call_guard.h"
#include "server/calls/handle.h"
#include "server/calls/memory_budget.h"
#include "server/catalogue/teacher.h"
#include "server/uploads/upload_service.h"
#include "storage/catalogue/catalogue.h"
#include "storage/uploads/uploads.h"
#include "tests/files/temporary_folder.h"
#include "tests/server/server_fixture.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

constexpr char kCancelledUpload[] = "uploads/cancelled";

// A log that runs a function once, on the thread that logs a line with these words.
class LogHook final : public spdlog::sinks::base_sink<spdlog::details::null_mutex> {
 public:
  explicit LogHook(std::string words) : words_(std::move(words)) {}

  void Set(std::function<void()> work) {
    absl::MutexLock lock(&work_mutex_);
    work_ = std::move(work);
  }

 protected:
  void sink_it_(const spdlog::details::log_msg& message) override {
    const std::string_view text(message.payload.data(), message.payload.size());
    if (text.find(words_) == std::string_view::npos) return;
    std::function<void()> work;
    {
      absl::MutexLock lock(&work_mutex_);
      work.swap(work_);
    }
    if (work) work();
  }
  void flush_() override {}

 private:
  const std::string words_;
  absl::Mutex work_mutex_;
  std::function<void()> work_ ABSL_GUARDED_BY(work_mutex_);
};

// An upload service whose first commit can be watched within the server.
class WatchedCommits final : public v1::UploadService::Service {
 public:
  explicit WatchedCommits(server::UploadService& uploads) : uploads_(uploads) {}

  grpc::Status CommitUpload(grpc::ServerContext* context, const v1::CommitUploadRequest* request,
                            v1::Upload* response) override {
    context_ = context;
    grpc::Status status = uploads_.CommitUpload(context, request, response);
    result_.set_value(status);
    return status;
  }

  // Returns once the server has noticed. To be called on a thread of the call.
  void AwaitCancelled() const {
    while (!server::IsAbandoned(*context_)) std::this_thread::yield();
  }
  // Waits for the end of the call in the server, which may be after that in the client.
  grpc::Status Result() { return result_.get_future().get(); }

 private:
  server::UploadService& uploads_;
  grpc::ServerContext* context_ = nullptr;
  std::promise<grpc::Status> result_;
};

// Three staged views without descriptors. The second one has a damaged cloud, which is logged
// between the description of the first and of the third one.
class CommitCancellationTest : public ::testing::Test {
 protected:
  void SetUp() override {
    spdlog::set_default_logger(std::make_shared<spdlog::logger>("hook", log_));
    spdlog::set_level(spdlog::level::err);
    v1::Object object;
    object.set_name("objects/wedge");
    ASSERT_THAT(catalogue_->CreateObject(object), IsOk());
    v1::StablePose pose;
    pose.set_name(FlatPoseOf("wedge"));
    ASSERT_THAT(catalogue_->CreateStablePose(pose), IsOk());
    storage::UploadRecord wanted;
    wanted.set_name(kCancelledUpload);
    const auto created = catalogue_->uploads().Create(wanted, absl::Now());
    ASSERT_THAT(created, IsOk());
    upload_ = *created;
    Stage("a", /*is_damaged=*/false);
    Stage("b", /*is_damaged=*/true);
    Stage("c", /*is_damaged=*/false);
    revision_ = catalogue_->revision();
    Serve();
  }

  void TearDown() override {
    server_.reset();
    spdlog::set_default_logger(before_);
    spdlog::set_level(spdlog::level::off);
  }

  static std::string NameOf(const std::string& id) { return FlatPoseOf("wedge") + "/views/" + id; }

  void Stage(const std::string& id, bool is_damaged) {
    const v1::UploadViewsRequest request = ViewOf("wedge", 0, id);
    auto view = server::MakeView(request, parameters_, {}, [] { return false; });
    ASSERT_THAT(view, IsOk());
    view->record.set_name(NameOf(id));
    view->record.set_content_digest(server::UploadDigest(request));
    view->record.clear_descriptors();
    if (is_damaged) view->packed_cloud = "damaged";
    ASSERT_THAT(catalogue_->uploads().Stage(upload_, *view), IsOk());
  }

  // Starts a server, after the end of the one before it.
  void Serve() {
    server_.reset();
    service_ = std::make_unique<WatchedCommits>(uploads_);
    grpc::ServerBuilder builder;
    builder.RegisterService(service_.get());
    server::GuardCalls(access_, builder);
    server_ = builder.BuildAndStart();
    stub_ = v1::UploadService::NewStub(server_->InProcessChannel(grpc::ChannelArguments()));
  }

  grpc::Status Commit(grpc::ClientContext* context, v1::Upload* response) {
    v1::CommitUploadRequest request;
    request.set_name(kCancelledUpload);
    return stub_->CommitUpload(context, request, response);
  }

  int StagedDescriptors(const std::string& id) {
    const auto view = catalogue_->uploads().GetStaged(upload_, NameOf(id));
    EXPECT_THAT(view, IsOk());
    return view.ok() ? view->record.descriptors_size() : -1;
  }

  // Nothing is visible, and what was described stays described.
  void ExpectOpen() {
    EXPECT_EQ(catalogue_->revision(), revision_);
    EXPECT_EQ(catalogue_->counts().views, 0);
    EXPECT_THAT(catalogue_->uploads().GetOpen(kCancelledUpload), IsOk());
    EXPECT_EQ(StagedDescriptors("a"), 1);
    EXPECT_EQ(StagedDescriptors("c"), 0);
  }

  void ExpectTheNextCommitSucceeds() {
    Serve();
    grpc::ClientContext context;
    v1::Upload response;
    ASSERT_THAT(Commit(&context, &response), IsGrpcOk());
    EXPECT_EQ(response.created_count(), 3);
    EXPECT_EQ(catalogue_->revision(), revision_ + 1);
    for (const char* id : {"a", "c"}) {
      EXPECT_EQ(catalogue_->GetView(NameOf(id))->descriptors_size(), 1) << id;
    }
  }

  const files::TemporaryFolder folder_;
  const recognition::RecognitionParameters parameters_ = {};
  const std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  const std::shared_ptr<LogHook> log_ = std::make_shared<LogHook>(NameOf("b"));
  const std::unique_ptr<storage::Catalogue> catalogue_ =
      storage::Catalogue::Open((folder_.path() / "db").string()).value();
  server::Admission teaching_{1, 1};
  server::RequestMemory memory_{std::size_t{1} << 30U};
  server::UploadService uploads_{
      server::UploadContext{*catalogue_, teaching_, memory_, parameters_, {}}};
  const server::AccessRules access_ = {};  // all calls are allowed
  storage::UploadRecord upload_;
  std::int64_t revision_ = 0;
  std::unique_ptr<WatchedCommits> service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<v1::UploadService::Stub> stub_;
};

TEST_F(CommitCancellationTest, ACancelledCallLeavesTheUploadOpen) {
  grpc::ClientContext context;
  log_->Set([&] {
    context.TryCancel();
    service_->AwaitCancelled();
  });
  v1::Upload response;
  EXPECT_EQ(Commit(&context, &response).error_code(), grpc::StatusCode::CANCELLED);
  ExpectError(service_->Result(), grpc::StatusCode::CANCELLED, "commit it again");
  ExpectOpen();
  ExpectTheNextCommitSucceeds();
}

TEST_F(CommitCancellationTest, AViewThatCannotBeTaughtEndsTheCommitBeforeItDescribes) {
  ASSERT_THAT(catalogue_->uploads().StageError(upload_, NameOf("d"),
                                               absl::InvalidArgumentError("no points")),
              IsOk());
  grpc::ClientContext context;
  v1::Upload response;
  ExpectError(Commit(&context, &response), grpc::StatusCode::FAILED_PRECONDITION, NameOf("d"));
  EXPECT_EQ(StagedDescriptors("a"), 0);
}

TEST_F(CommitCancellationTest, AShutdownThatCancelsItsCallsLeavesTheUploadOpen) {
  std::thread stopping;
  log_->Set([&] {
    // As at the end of the drain time.
    stopping = std::thread([&] { server_->Shutdown(std::chrono::system_clock::now()); });
    service_->AwaitCancelled();
  });
  grpc::ClientContext context;
  v1::Upload response;
  EXPECT_FALSE(Commit(&context, &response).ok());
  ExpectError(service_->Result(), grpc::StatusCode::CANCELLED, "commit it again");
  ASSERT_TRUE(stopping.joinable());
  stopping.join();
  ExpectOpen();
  ExpectTheNextCommitSucceeds();
}

}  // namespace
}  // namespace graspdb::testing
