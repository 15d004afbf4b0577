// Sessions of robots, and jobs that throw.
#include <gmock/gmock.h>

#include <atomic>
#include <stdexcept>
#include <thread>

#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "client/cell/robots/robot_session.h"
#include "tests/client/cell/robots/scripted_runner.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::StatusIs;
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
    while (session_->StatusOf(kPickJob) == GriJobStatus::kRunning && absl::Now() < end) {
      std::this_thread::yield();
    }
    return session_->StatusOf(kPickJob);
  }

  ThrowingRunner runner_;
  RobotJobs jobs_{runner_};
  const std::shared_ptr<RobotSession> session_ = *jobs_.SessionOf("robot");
  const JobRequest request_ = {.job = kPickJob, .session = *session_};
};

TEST_F(RobotJobsTest, AnExceptionFailsTheJobAndIsReported) {
  const JobAnswer answer = jobs_.Run(request_);
  EXPECT_NE(answer.code, GriCode::kNoError);
  EXPECT_THAT(answer.why, HasSubstr("no such lens"));
  EXPECT_EQ(session_->StatusOf(kPickJob), GriJobStatus::kFailed);
  EXPECT_EQ(jobs_.Run(request_).code, GriCode::kNoError);
}

TEST_F(RobotJobsTest, AnExceptionInTheBackgroundFailsTheJobAndIsReported) {
  ASSERT_EQ(jobs_.Start(request_).code, GriCode::kNoError);
  EXPECT_EQ(StatusAtTheEnd(), GriJobStatus::kFailed);
  EXPECT_THAT(jobs_.Next(*session_, kPickJob).why, HasSubstr("no such lens"));
  ASSERT_EQ(jobs_.Start(request_).code, GriCode::kNoError);
  EXPECT_EQ(StatusAtTheEnd(), GriJobStatus::kDone);
}

// Waits in each run until `go_on`.
class WaitingRunner : public ScriptedRunner {
 public:
  WaitingRunner() { Set(kPickJob, std::vector<JobPose>(2)); }
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override {
    go_on.WaitForNotification();
    return ScriptedRunner::Run(request);
  }
  absl::Notification go_on;
};

class RobotSessionsTest : public ::testing::Test {
 protected:
  std::shared_ptr<RobotSession> SessionOf(const std::string& robot) {
    return jobs_.SessionOf(robot).value_or(nullptr);
  }

  GriCode Run(const std::string& robot) {
    return jobs_.Run({.job = kPickJob, .session = *SessionOf(robot)}).code;
  }

  void Start(const std::string& robot) {
    const JobRequest request = {.job = kPickJob, .session = *SessionOf(robot)};
    ASSERT_EQ(jobs_.Start(request).code, GriCode::kNoError);
  }

  GriCode Next(const std::string& robot) { return jobs_.Next(*SessionOf(robot), kPickJob).code; }

  // Requests of `count` robots, each with a name of its own.
  void Visit(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) SessionOf("visitor " + std::to_string(i));
  }

  WaitingRunner runner_;
  RobotJobs jobs_{runner_};
};

TEST_F(RobotSessionsTest, TheLeastRecentlyUsedSessionIsReplaced) {
  runner_.go_on.Notify();
  ASSERT_EQ(Run("first"), GriCode::kNoError);
  ASSERT_EQ(Run("second"), GriCode::kNoError);
  Visit(kMaxSessions - 2);
  SessionOf("first");  // used again
  SessionOf("new");
  EXPECT_EQ(Next("first"), GriCode::kNoError);
  EXPECT_EQ(Next("second"), GriCode::kNoPosesFound);
}

TEST_F(RobotSessionsTest, ARobotWithoutItsSessionIsLikeANewOne) {
  runner_.go_on.Notify();
  ASSERT_EQ(Run("robot"), GriCode::kNoError);
  SessionOf("robot")->SetFormat(4);
  SessionOf("robot")->SetGiven({});
  SessionOf("robot")->SetScene(std::make_shared<RunnerScene>());
  Visit(kMaxSessions);
  const auto session = SessionOf("robot");
  EXPECT_EQ(session->StatusOf(kPickJob), GriJobStatus::kInactive);
  EXPECT_FALSE(session->LastPrimary(kPickJob));
  EXPECT_FALSE(session->format());
  EXPECT_FALSE(session->TakeGiven());
  EXPECT_EQ(session->scene(), nullptr);
  EXPECT_EQ(Run("robot"), GriCode::kNoError);
  EXPECT_EQ(Next("robot"), GriCode::kNoError);
}

TEST_F(RobotSessionsTest, ASessionWithARunningJobIsNotReplaced) {
  Start("robot");
  Visit(2 * kMaxSessions);
  EXPECT_EQ(Next("robot"), GriCode::kJobStillRunning);
  runner_.go_on.Notify();
  while (Next("robot") == GriCode::kJobStillRunning) std::this_thread::yield();
  EXPECT_EQ(Next("robot"), GriCode::kNoError) << "the second pose";
}

TEST_F(RobotSessionsTest, ASessionInUseIsNotReplaced) {
  const auto session = SessionOf("robot");
  session->SetFormat(4);
  Visit(2 * kMaxSessions);
  EXPECT_EQ(SessionOf("robot"), session);
}

TEST_F(RobotSessionsTest, ANewRobotIsRefusedWhileJobsOfAllOthersRun) {
  for (std::size_t i = 0; i < kMaxSessions; ++i) Start(std::to_string(i));
  EXPECT_THAT(jobs_.SessionOf("new"),
              StatusIs(absl::StatusCode::kResourceExhausted, HasSubstr("64 other robots")));
  EXPECT_EQ(Next("0"), GriCode::kJobStillRunning);
  runner_.go_on.Notify();
  while (!jobs_.SessionOf("new").ok()) std::this_thread::yield();
  EXPECT_EQ(Run("new"), GriCode::kNoError);
}

// Robots replace each other's sessions while jobs run in some of them.
TEST_F(RobotSessionsTest, ManyThreadsMayUseThem) {
  runner_.go_on.Notify();
  std::vector<std::thread> robots;
  robots.reserve(4);
  for (std::size_t thread = 0; thread < 4; ++thread) {
    robots.emplace_back([this, thread] {
      for (std::size_t i = 0; i < 2 * kMaxSessions; ++i) {
        const auto session = SessionOf(std::to_string((i + 7 * thread) % (kMaxSessions + 8)));
        if (session == nullptr) continue;
        const JobRequest request = {.job = kPickJob, .session = *session};
        const JobAnswer answer = i % 2 == 0 ? jobs_.Start(request) : jobs_.Run(request);
        EXPECT_TRUE(answer.code == GriCode::kNoError || answer.code == GriCode::kJobStillRunning ||
                    answer.code == GriCode::kNoPosesFound);
      }
    });
  }
  for (std::thread& robot : robots) robot.join();
}

}  // namespace
}  // namespace graspdb::client
