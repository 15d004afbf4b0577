// Calls that a busy server refuses.
#include <gmock/gmock.h>
#include <grpcpp/server_builder.h>

#include <deque>
#include <optional>
#include <set>
#include <thread>

#include "absl/strings/cord.h"
#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"
#include "client/sdk/connection.h"
#include "graspdb/v1/catalog_service.grpc.pb.h"
#include "graspdb/v1/recognition_service.grpc.pb.h"
#include "server/base/errors.h"
#include "server/calls/admission.h"
#include "tests/testing/busy_status.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using testing::BusyFor;
using testing::IsOk;
using testing::StatusIs;

constexpr absl::Duration kShort = absl::Milliseconds(1);
constexpr absl::Duration kForEver = absl::Hours(1);

// Refuses calls for lack of room, as the server does.
class BusyServer : public v1::RecognitionService::Service, public v1::CatalogService::Service {
 public:
  BusyServer() {
    grpc::ServerBuilder builder;
    builder.RegisterService(static_cast<v1::RecognitionService::Service*>(this));
    builder.RegisterService(static_cast<v1::CatalogService::Service*>(this));
    server_ = builder.BuildAndStart();
  }

  Client Connect(ConnectionOptions options = {.timeout = kForEver}) {
    return {server_->InProcessChannel({}), std::move(options)};
  }

  grpc::Status Recognize(grpc::ServerContext*, const v1::RecognizeRequest*,
                         v1::RecognizeResponse*) override {
    const auto ticket = admission.Enter([] { return false; });
    Count();
    return server::ToGrpcStatus(ticket.status());
  }
  grpc::Status CreateObject(grpc::ServerContext*, const v1::CreateObjectRequest*,
                            v1::Object*) override {
    Count();
    absl::MutexLock lock(&mutex_);
    if (answers.empty()) return grpc::Status::OK;
    grpc::Status out = answers.front();
    answers.pop_front();
    return out;
  }

  int calls() const {
    absl::MutexLock lock(&mutex_);
    return calls_;
  }
  void AwaitCalls(int count) const {
    const auto enough = [&]() ABSL_SHARED_LOCKS_REQUIRED(mutex_) { return calls_ >= count; };
    absl::MutexLock lock(&mutex_, absl::Condition(&enough));
  }

  server::Admission admission{/*slots=*/1, /*waiting=*/0};
  std::deque<grpc::Status> answers;  // of CreateObject, in order; then OK

 private:
  void Count() {
    absl::MutexLock lock(&mutex_);
    ++calls_;
  }

  mutable absl::Mutex mutex_;
  int calls_ ABSL_GUARDED_BY(mutex_) = 0;
  std::unique_ptr<grpc::Server> server_;
};

class BusyServerTest : public ::testing::Test {
 protected:
  BusyServer server_;
};

TEST_F(BusyServerTest, ACallThatWasRefusedSucceedsOnceASlotIsFree) {
  auto occupied = std::optional(server_.admission.Enter([] { return false; }));
  ASSERT_THAT(*occupied, IsOk());
  std::thread leaving([&] {
    server_.AwaitCalls(2);
    occupied.reset();
  });
  Client client = server_.Connect({.timeout = kForEver, .busy_retries = 1000});
  EXPECT_THAT(client.Recognize({}), IsOk());
  leaving.join();
  EXPECT_GE(server_.calls(), 3);
}

TEST_F(BusyServerTest, WritesAreRetriedAsWellSinceTheyHaveNotBegun) {
  server_.answers = {BusyFor(kShort), BusyFor(kShort)};
  EXPECT_THAT(server_.Connect().CreateObject({}), IsOk());
  EXPECT_EQ(server_.calls(), 3);
}

TEST_F(BusyServerTest, TheDeadlineEndsItWithTheServersError) {
  server_.answers = {BusyFor(absl::Seconds(20))};
  Client client = server_.Connect({.timeout = absl::Seconds(15)});
  EXPECT_THAT(client.CreateObject({}),
              StatusIs(absl::StatusCode::kResourceExhausted, "the queue is full"));
  EXPECT_EQ(server_.calls(), 1);
}

TEST_F(BusyServerTest, TheNumberOfRetriesIsLimited) {
  server_.answers = std::deque<grpc::Status>(10, BusyFor(kShort));
  Client client = server_.Connect({.timeout = kForEver, .busy_retries = 2});
  EXPECT_THAT(client.CreateObject({}), StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_EQ(server_.calls(), 3);
}

TEST_F(BusyServerTest, NothingIsRetriedIfRetriesAreDisabled) {
  server_.answers = {BusyFor(kShort)};
  Client client = server_.Connect({.timeout = kForEver, .retry = false});
  EXPECT_THAT(client.CreateObject({}), StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_EQ(server_.calls(), 1);
}

TEST_F(BusyServerTest, FramesAreNotRetriedIfTheCallerTakesNewOnes) {
  const auto occupied = server_.admission.Enter([] { return false; });
  ASSERT_THAT(occupied, IsOk());
  Client client = server_.Connect({.timeout = kForEver, .retry_frames = false});
  EXPECT_THAT(client.Recognize({}), StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_EQ(server_.calls(), 1);
}

TEST_F(BusyServerTest, WithoutARetryInfoACallIsNotRetried) {
  const grpc::Status full = server::ToGrpcStatus(absl::ResourceExhaustedError("the disk is full"));
  server_.answers = {full, {grpc::StatusCode::RESOURCE_EXHAUSTED, "message is too large"}};
  Client client = server_.Connect();
  EXPECT_THAT(client.CreateObject({}),
              StatusIs(absl::StatusCode::kResourceExhausted, "the disk is full"));
  EXPECT_THAT(client.CreateObject({}),
              StatusIs(absl::StatusCode::kResourceExhausted, "message is too large"));
  EXPECT_EQ(server_.calls(), 2);
}

TEST_F(BusyServerTest, StoppingEndsTheWait) {
  server_.answers = {BusyFor(absl::Seconds(25)), BusyFor(absl::Seconds(25))};
  Client client = server_.Connect();
  std::thread stop([&] {
    server_.AwaitCalls(1);
    client.StopRetries();
  });
  EXPECT_THAT(client.CreateObject({}), StatusIs(absl::StatusCode::kResourceExhausted));
  stop.join();
  EXPECT_THAT(client.CreateObject({}), StatusIs(absl::StatusCode::kResourceExhausted));
  EXPECT_EQ(server_.calls(), 2);
}

TEST(BusyDelayTest, IsThatOfTheRetryInfo) {
  const auto delay_of = [](absl::StatusCode code, const std::string& details) {
    absl::Status status(code, "");
    status.SetPayload(kErrorDetails, absl::Cord(details));
    return BusyDelay(status);
  };
  constexpr auto kCode = absl::StatusCode::kResourceExhausted;
  const std::string details = BusyFor(absl::Milliseconds(1250)).error_details();
  EXPECT_EQ(delay_of(kCode, details), absl::Milliseconds(1250));
  EXPECT_EQ(delay_of(absl::StatusCode::kUnavailable, details), std::nullopt);
  EXPECT_EQ(delay_of(kCode, "no message"), std::nullopt);
  EXPECT_EQ(delay_of(kCode, BusyFor(absl::Hours(1)).error_details()), std::nullopt);
  EXPECT_EQ(delay_of(kCode, BusyFor(-absl::Seconds(1)).error_details()), std::nullopt);
}

TEST(BusyDelayTest, IsThatOfOurServersWhereGrpcHasNoThread) {
  EXPECT_EQ(BusyDelay(absl::ResourceExhaustedError("Server Threadpool Exhausted")),
            absl::Milliseconds(100));
  EXPECT_EQ(BusyDelay(absl::ResourceExhaustedError("Received message larger than max")),
            std::nullopt);
}

TEST(BackoffTest, ClientsThatWereRefusedTogetherComeBackAtDifferentTimes) {
  constexpr absl::Duration kDelay = absl::Milliseconds(100);
  constexpr int kCells = 100;
  std::set<absl::Duration> firsts;
  for (std::uint64_t seed = 0; seed < kCells; ++seed) {
    firsts.insert(Backoff(kDelay, absl::Seconds(1), seed).Next(kDelay));
  }
  EXPECT_EQ(firsts.size(), kCells);
  EXPECT_GE(*firsts.begin(), kDelay);
  EXPECT_LT(*firsts.rbegin(), 2 * kDelay);
  // No tenth of the span has more than a third of them.
  for (absl::Duration from = kDelay; from < 2 * kDelay; from += kDelay / 10) {
    const auto count =
        std::distance(firsts.lower_bound(from), firsts.lower_bound(from + kDelay / 10));
    EXPECT_LT(count, kCells / 3) << from;
  }
}

TEST(BackoffTest, PausesGrowUpToALimitAndRepeatWithTheirSeed) {
  Backoff one(absl::Milliseconds(100), absl::Seconds(1), 7);
  Backoff same(absl::Milliseconds(100), absl::Seconds(1), 7);
  absl::Duration longest;
  for (int i = 0; i < 100; ++i) {
    const absl::Duration pause = one.Next(absl::ZeroDuration());
    EXPECT_EQ(same.Next(absl::ZeroDuration()), pause);
    longest = std::max(longest, pause);
  }
  EXPECT_GT(longest, absl::Milliseconds(800));
  EXPECT_LT(longest, absl::Seconds(1));
}

TEST(BackoffTest, SeedsOfClientsDiffer) {
  Backoff one(absl::Seconds(1), absl::Seconds(1));
  Backoff other(absl::Seconds(1), absl::Seconds(1));
  EXPECT_NE(one.Next(absl::ZeroDuration()), other.Next(absl::ZeroDuration()));
}

}  // namespace
}  // namespace graspdb::client
