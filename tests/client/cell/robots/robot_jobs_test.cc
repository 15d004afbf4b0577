// Exceptions of the runner end the job and are reported.
#include "client/cell/robots/robot_jobs.h"

#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "absl/time/clock.h"
#include "tests/client/cell/robots/scripted_runner.h"

namespace graspdb::client {
namespace {

using ::testing::HasSubstr;

constexpr int kPickJob = 4;

// Throws `throws_` times, then follows its script.
class ThrowingRunner : public ScriptedRunner {
 public:
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override {
    if (throws_-- > 0) throw std::runtime_error("no such lens");
    return ScriptedRunner::Run(request);
  }
  std::atomic<int> throws_ = 1;
};

class RobotJobsTest : public ::testing::Test {
 protected:
  void SetUp() override { runner_.Set(kPickJob, std::vector<JobPose>(1)); }

  GriJobStatus StatusAtTheEnd() {
    const absl::Time end =
        absl::Now() + absl::Minutes(1);  // far longer than a job that does nothing
    while (jobs_.StatusOf("robot", kPickJob) == GriJobStatus::kRunning && absl::Now() < end) {
      std::this_thread::yield();
    }
    return jobs_.StatusOf("robot", kPickJob);
  }

  const JobRequest request_ = {.job = kPickJob, .robot = "robot"};
  ThrowingRunner runner_;
  RobotJobs jobs_{runner_};
};

TEST_F(RobotJobsTest, AnExceptionFailsTheJobAndIsReported) {
  const JobAnswer answer = jobs_.Run(request_);
  EXPECT_NE(answer.code, GriCode::kNoError);
  EXPECT_THAT(answer.why, HasSubstr("no such lens"));
  EXPECT_EQ(jobs_.StatusOf("robot", kPickJob), GriJobStatus::kFailed);
  EXPECT_EQ(jobs_.Run(request_).code, GriCode::kNoError);
}

TEST_F(RobotJobsTest, AnExceptionInTheBackgroundFailsTheJobAndIsReported) {
  ASSERT_EQ(jobs_.Start(request_).code, GriCode::kNoError);
  EXPECT_EQ(StatusAtTheEnd(), GriJobStatus::kFailed);
  EXPECT_THAT(jobs_.Next("robot", kPickJob).why, HasSubstr("no such lens"));
  ASSERT_EQ(jobs_.Start(request_).code, GriCode::kNoError);
  EXPECT_EQ(StatusAtTheEnd(), GriJobStatus::kDone);
}

}  // namespace
}  // namespace graspdb::client
