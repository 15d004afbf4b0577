// Schedule of a load test. Times have lower bounds from the sleeps and no upper bounds.
#include "lab/load/load_run.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <latch>
#include <mutex>
#include <thread>
#include <vector>

namespace graspdb::lab {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::Ge;
using ::testing::Le;

// Answers after a delay and records the requests.
class Server {
 public:
  explicit Server(milliseconds time) : time_(time) {}

  SendRequest Sender() {
    return [this](int worker, std::int64_t request) -> absl::StatusOr<v1::RecognizeResponse> {
      {
        const std::lock_guard lock(mutex_);
        requests_.push_back(request);
        workers_.push_back(worker);
        most_ = std::max(most_, ++running_);
      }
      std::this_thread::sleep_for(time_);
      const std::lock_guard lock(mutex_);
      --running_;
      if (!error_.ok()) return error_;
      return v1::RecognizeResponse();
    };
  }

  void FailWith(const absl::Status& error) { error_ = error; }
  std::vector<std::int64_t> SortedRequests() const {
    std::vector<std::int64_t> out = requests_;
    std::sort(out.begin(), out.end());
    return out;
  }
  const std::vector<int>& workers() const { return workers_; }
  int most() const { return most_; }

 private:
  const milliseconds time_;
  absl::Status error_;
  std::mutex mutex_;  // guards the members below
  std::vector<std::int64_t> requests_;
  std::vector<int> workers_;
  int running_ = 0;
  int most_ = 0;
};

std::vector<std::int64_t> UpTo(std::int64_t count) {
  std::vector<std::int64_t> out;
  for (std::int64_t i = 0; i < count; ++i) out.push_back(i);
  return out;
}

TEST(LoadRun, ClosedLoopSendsEachRequestOnce) {
  Server server(milliseconds(5));
  const LoadResult result = RunLoad({.concurrency = 3, .requests = 40}, server.Sender(), {});
  EXPECT_EQ(server.SortedRequests(), UpTo(40));
  EXPECT_LE(server.most(), 3);
  EXPECT_THAT(server.workers(), Each(AllOf(Ge(0), Le(2))));
  EXPECT_EQ(result.tally.answered(), 40);
  EXPECT_GE(result.tally.latency().Min(), milliseconds(5));
  EXPECT_EQ(result.tally.lateness().Max(), milliseconds(0));
  EXPECT_GE(result.elapsed, milliseconds(40 / 3 * 5));
  EXPECT_FALSE(result.cancelled);
}

TEST(LoadRun, AllWorkersSendConcurrently) {
  std::latch together(3);  // no answer before three requests
  const SendRequest send = [&](int, std::int64_t) {
    together.arrive_and_wait();
    return absl::StatusOr<v1::RecognizeResponse>(v1::RecognizeResponse());
  };
  EXPECT_EQ(RunLoad({.concurrency = 3, .requests = 3}, send, {}).tally.answered(), 3);
}

TEST(LoadRun, EndsAfterTheDuration) {
  Server server(milliseconds(10));
  const LoadResult result =
      RunLoad({.concurrency = 1, .duration = milliseconds(100)}, server.Sender(), {});
  EXPECT_LE(result.tally.answered(), 10);
}

TEST(LoadRun, OpenLoopSendsNoRequestBeforeItIsDue) {
  Server server(milliseconds(0));
  const LoadResult result =
      RunLoad({.concurrency = 4, .rate = 100, .requests = 20}, server.Sender(), {});
  EXPECT_EQ(server.SortedRequests(), UpTo(20));
  EXPECT_GE(result.elapsed, milliseconds(190));  // when the last one was due
}

TEST(LoadRun, LatencyCountsFromTheDueTime) {
  Server server(milliseconds(20));
  const LoadPlan plan{.concurrency = 1, .rate = 1000, .requests = 10};
  const LoadResult result = RunLoad(plan, server.Sender(), {});
  // The last is due after 9 ms, and sent when nine others have had their 20 ms.
  EXPECT_GE(result.tally.lateness().Max(), milliseconds(9 * 20 - 9));
  EXPECT_GE(result.tally.latency().Max(), milliseconds(10 * 20 - 9));
  EXPECT_GE(result.backlog, 9 * 20 - 9);
  EXPECT_FALSE(KeptRate(plan, result));
}

TEST(LoadRun, ReportsTheBacklog) {
  Server server(milliseconds(100));
  const LoadPlan plan{.concurrency = 2, .rate = 1000, .duration = milliseconds(200)};
  const LoadResult result = RunLoad(plan, server.Sender(), {});
  EXPECT_LE(result.tally.answered(), 4);  // two at a time, 100 ms each
  EXPECT_EQ(result.tally.answered() + result.backlog, 200);
  EXPECT_FALSE(KeptRate(plan, result));
}

TEST(LoadRun, KeptRateLeavesNoBacklog) {
  const LoadPlan plan{.concurrency = 1, .rate = 10, .requests = 100};
  LoadResult result;
  for (int i = 0; i < 100; ++i) result.tally.AddAnswer({}, {});
  EXPECT_TRUE(KeptRate(plan, result));
  result.backlog = 2;
  EXPECT_TRUE(KeptRate(plan, result));
  result.backlog = 3;
  EXPECT_FALSE(KeptRate(plan, result));
  EXPECT_TRUE(KeptRate({.requests = 100}, result)) << "a closed loop has no rate to keep";
}

TEST(LoadRun, CancellingEndsALongWait) {
  Server server(milliseconds(0));
  std::int64_t reported = 0;
  const LoadWatch watch = {
      .report = [&](std::int64_t requests, std::chrono::nanoseconds) { reported = requests; },
      .cancelled = [&] { return reported == 1; }};
  const LoadPlan plan{.concurrency = 2, .rate = 0.001, .duration = hours(10)};
  const LoadResult result = RunLoad(plan, server.Sender(), watch);
  EXPECT_TRUE(result.cancelled);
  EXPECT_EQ(result.tally.answered(), 1);  // the next one is due after a quarter of an hour
  EXPECT_EQ(result.backlog, 0);
}

TEST(LoadRun, CountsErrorsAndContinues) {
  Server server(milliseconds(0));
  server.FailWith(absl::NotFoundError("no such cell"));
  const LoadResult result = RunLoad({.concurrency = 2, .requests = 30}, server.Sender(), {});
  EXPECT_EQ(result.tally.answered(), 0);
  EXPECT_EQ(result.tally.failed(), 30);
  EXPECT_EQ(result.RequestsPerSecond(), 0);
}

TEST(LoadRun, WorkerPausesWithoutAServer) {
  Server server(milliseconds(0));
  server.FailWith(absl::UnavailableError("gone"));
  const LoadResult result = RunLoad({.concurrency = 1, .requests = 3}, server.Sender(), {});
  EXPECT_EQ(result.tally.failed(), 3);
  EXPECT_GE(result.elapsed, milliseconds(200));
}

}  // namespace
}  // namespace graspdb::lab
