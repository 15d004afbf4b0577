// Valid and invalid use of the Generic Robot Interface over TCP.
#include <gmock/gmock.h>

#include <atomic>
#include <random>
#include <stdexcept>
#include <string_view>
#include <thread>
#include <vector>

#include "absl/synchronization/notification.h"
#include "client/cell/robots/gri/gri_protocol.h"
#include "tests/client/cell/robots/socket_robot.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;

// Job 1 finds one pose whose x is the robot's own plus a metre; job 2 waits before that.
class EchoRunner : public JobRunner {
 public:
  bool IsReady() override { return true; }
  absl::Status Check(int job) override {
    return job == 1 || job == 2 ? absl::OkStatus() : absl::NotFoundError("no such job");
  }
  absl::StatusOr<std::vector<JobPose>> Run(const JobRequest& request) override {
    started = true;
    if (request.job == 2) go_on.WaitForNotification();
    if (!request.base_flange) return absl::InvalidArgumentError("where is the robot?");
    Pose found = *request.base_flange;
    found.translation().x() += 1;
    return std::vector<JobPose>{{found, {}}};
  }
  absl::Status ReportOutcome(RobotSession& /*session*/, PickOutcome /*outcome*/) override {
    return absl::OkStatus();
  }

  absl::Notification go_on;
  std::atomic<bool> started = false;
};

std::string RequestBytes(GriAction action, int job = 1, double x_m = 0) {
  GriRequest request;
  request.action = static_cast<std::uint8_t>(action);
  request.job_id = static_cast<std::uint16_t>(job);
  Pose flange = Pose::Identity();
  flange.translation().x() = x_m;
  request.pose = *ToGriPose(flange, request.pose_format);
  const auto bytes = GriBytes(request);
  return {bytes.begin(), bytes.end()};
}

GriResponse Response(const std::string& bytes) {
  std::array<std::uint8_t, kGriResponseBytes> fixed = {'G', 'R',         'I',
                                                       0,   kGriVersion, kGriResponseBytes};
  EXPECT_EQ(bytes.size(), fixed.size());
  std::ranges::copy(bytes.substr(0, fixed.size()), fixed.begin());
  const auto response = ParseGriResponse(fixed);
  EXPECT_THAT(response, IsOk());
  return *response;
}

class GriServerTest : public ::testing::Test {
 protected:
  void SetUp() override { Start({}); }

  void Start(const RobotServerOptions& options) {
    server_.reset();
    auto started = RobotServer::Start(protocol_, options);
    ASSERT_THAT(started, IsOk());
    server_ = *std::move(started);
  }

  static GriResponse Call(SocketRobot& robot, const std::string& request) {
    robot.Send(request);
    return Response(robot.Receive(kGriResponseBytes));
  }

  bool IsServing() {
    SocketRobot robot(server_->port());
    return Call(robot, RequestBytes(GriAction::kStatus)).data[1] == 1;
  }

  EchoRunner runner_;
  GriJobs jobs_{runner_};
  GriProtocol protocol_{jobs_};
  std::unique_ptr<RobotServer> server_;
};

TEST_F(GriServerTest, AnswersManyRequestsInOrder) {
  SocketRobot robot(server_->port());
  std::string all;
  for (int i = 0; i < 50; ++i) all += RequestBytes(GriAction::kTriggerJobSync, 1, 0.01 * i);
  robot.Send(all);
  for (int i = 0; i < 50; ++i) {
    const GriResponse answer = Response(robot.Receive(kGriResponseBytes));
    EXPECT_EQ(answer.code, GriCode::kNoError);
    EXPECT_NEAR(answer.pose.position[0], 1e9 + 1e7 * i, 1);
  }
}

TEST_F(GriServerTest, AcceptsMessagesByteByByte) {
  SocketRobot robot(server_->port());
  for (const char byte : RequestBytes(GriAction::kTriggerJobSync)) robot.Send({byte});
  EXPECT_EQ(Response(robot.Receive(kGriResponseBytes)).code, GriCode::kNoError);
}

TEST_F(GriServerTest, HeaderErrorsKeepTheConnection) {
  SocketRobot robot(server_->port());
  const auto call_with = [&](std::size_t at, char value) {
    std::string request = RequestBytes(GriAction::kStatus);
    request[at] = value;
    return Call(robot, request);
  };
  EXPECT_EQ(call_with(4, 2).code, GriCode::kUnknownProtocolVersion);
  EXPECT_EQ(call_with(6, 52).code, GriCode::kInvalidRequest);
  EXPECT_EQ(call_with(7, 10).code, GriCode::kInvalidAction);
  EXPECT_EQ(call_with(7, 10).job_id, 1);
  EXPECT_EQ(Call(robot, RequestBytes(GriAction::kTriggerJobSync, 9)).code,
            GriCode::kJobDoesNotExist);
  EXPECT_EQ(call_with(7, 1).code, GriCode::kNoError);
}

TEST_F(GriServerTest, AWrongLengthClosesTheConnection) {
  SocketRobot robot(server_->port());
  std::string request = RequestBytes(GriAction::kStatus);
  request[5] = 53;
  const GriResponse answer = Call(robot, request);
  EXPECT_EQ(answer.code, GriCode::kInvalidRequestLength);
  EXPECT_EQ(answer.action, 1);
  EXPECT_TRUE(robot.IsHungUpOn());
  EXPECT_TRUE(IsServing());
}

TEST_F(GriServerTest, AnUnknownVersionIsReportedWhateverItsLength) {
  SocketRobot robot(server_->port());
  std::string request = RequestBytes(GriAction::kStatus);
  request[4] = 2;
  request[5] = 53;
  EXPECT_EQ(Call(robot, request).code, GriCode::kUnknownProtocolVersion);
  EXPECT_TRUE(robot.IsHungUpOn());
}

TEST_F(GriServerTest, GarbageGetsOneAnswerAndClosesTheConnection) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 100; ++i) {
    SocketRobot robot(server_->port());
    std::string garbage(1 + random() % 20'000, '\0');
    for (char& byte : garbage) byte = static_cast<char>(random());
    garbage[0] = 'X';
    EXPECT_EQ(Call(robot, garbage).code, GriCode::kInvalidRequest);
    EXPECT_TRUE(robot.IsHungUpOn());
  }
  EXPECT_TRUE(IsServing());
}

TEST_F(GriServerTest, AnIncompleteMessageTimesOut) {
  Start({.message_time = std::chrono::milliseconds(50)});
  for (const std::size_t bytes : {1U, 7U, 8U, 53U}) {
    SocketRobot robot(server_->port());
    robot.Send(RequestBytes(GriAction::kStatus).substr(0, bytes));
    EXPECT_TRUE(robot.IsHungUpOn()) << bytes;
  }
  SocketRobot idle(server_->port());
  std::this_thread::sleep_for(std::chrono::milliseconds(150));
  EXPECT_EQ(Call(idle, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
}

TEST_F(GriServerTest, ToleratesDisconnectsDuringMessagesAndJobs) {
  for (int i = 0; i < 20; ++i) {
    SocketRobot robot(server_->port());
    robot.Send(RequestBytes(GriAction::kTriggerJobSync).substr(0, 20));
  }
  {
    SocketRobot robot(server_->port());
    robot.Send(RequestBytes(GriAction::kTriggerJobSync, 2));
    while (!runner_.started) std::this_thread::yield();
  }
  runner_.go_on.Notify();
  EXPECT_TRUE(IsServing());
}

TEST_F(GriServerTest, ServesAHundredRobotsAtOnce) {
  std::vector<std::unique_ptr<SocketRobot>> robots;
  robots.reserve(100);
  for (int i = 0; i < 100; ++i) robots.push_back(std::make_unique<SocketRobot>(server_->port()));
  for (int round = 0; round < 5; ++round) {
    for (auto& robot : robots) robot->Send(RequestBytes(GriAction::kStatus));
    for (auto& robot : robots) {
      EXPECT_EQ(Response(robot->Receive(kGriResponseBytes)).data[1], 1);
    }
  }
}

TEST_F(GriServerTest, ASlowJobDoesNotBlockOthers) {
  SocketRobot slow(server_->port());
  slow.Send(RequestBytes(GriAction::kTriggerJobSync, 2));
  EXPECT_TRUE(IsServing());
  runner_.go_on.Notify();
  EXPECT_EQ(Response(slow.Receive(kGriResponseBytes)).code, GriCode::kNoError);
}

TEST_F(GriServerTest, TooManyConnectionsAreRejected) {
  Start({.max_connections = 2});
  SocketRobot first(server_->port());
  SocketRobot second(server_->port());
  EXPECT_EQ(Call(first, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
  EXPECT_EQ(Call(second, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
  SocketRobot third(server_->port());
  EXPECT_TRUE(third.IsHungUpOn());
  EXPECT_EQ(Call(first, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
}

TEST_F(GriServerTest, ARobotThatClosesNoConnectionLeavesSomeForOthers) {
  Start({.max_connections_per_robot = 2});
  SocketRobot first(server_->port());
  SocketRobot second(server_->port());
  EXPECT_EQ(Call(second, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
  SocketRobot third(server_->port());
  EXPECT_TRUE(third.IsHungUpOn());
  SocketRobot other(server_->port(), "127.0.0.2");
  EXPECT_EQ(Call(other, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
  EXPECT_EQ(Call(first, RequestBytes(GriAction::kStatus)).code, GriCode::kNoError);
}

// Throws for "throw", and returns all else.
class ThrowingProtocol : public RobotProtocol {
 public:
  std::size_t MessageBytes(std::string_view received) const override { return received.size(); }
  RobotReply Answer(const std::string& /*robot*/, std::string_view message) override {
    if (message == "throw") throw std::runtime_error("no such lens");
    return {.bytes = std::string(message)};
  }
};

TEST(RobotServerTest, AnExceptionClosesItsConnectionOnly) {
  ThrowingProtocol protocol;
  const auto server = RobotServer::Start(protocol, {});
  ASSERT_THAT(server, IsOk());
  SocketRobot other((*server)->port());
  SocketRobot robot((*server)->port());
  robot.Send("throw");
  EXPECT_TRUE(robot.IsHungUpOn());
  other.Send("echo");
  EXPECT_EQ(other.Receive(4), "echo");
}

TEST_F(GriServerTest, OnlyRobotsOfTheAllowListAreServed) {
  Start({.allow = {"10.3.0.0/24"}});
  EXPECT_TRUE(SocketRobot(server_->port()).IsHungUpOn());
  Start({.allow = {"10.3.0.0/24", "127.0.0.0/8"}});
  EXPECT_TRUE(IsServing());
  EXPECT_THAT(RobotServer::Start(protocol_, {.allow = {"10.3.0.0/99"}}),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST_F(GriServerTest, DestructionClosesConnectionsAndWaitsForJobs) {
  SocketRobot robot(server_->port());
  robot.Send(RequestBytes(GriAction::kTriggerJobSync, 2));
  while (!runner_.started) std::this_thread::yield();
  std::thread stop([&] { server_.reset(); });
  EXPECT_TRUE(robot.IsHungUpOn());
  runner_.go_on.Notify();
  stop.join();
}

TEST_F(GriServerTest, APortInUseAndAnInvalidAddressAreErrors) {
  EXPECT_THAT(RobotServer::Start(protocol_, {.port = server_->port()}),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(RobotServer::Start(protocol_, {.address = "nowhere"}),
              StatusIs(absl::StatusCode::kInvalidArgument));
}

}  // namespace
}  // namespace graspdb::client
