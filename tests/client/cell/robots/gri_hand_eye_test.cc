
#include <gmock/gmock.h>

#include <array>
#include <numbers>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/synchronization/notification.h"
#include "client/cell/robots/gri/gri_protocol.h"
#include "tests/client/cell/robots/scripted_runner.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using ::testing::ElementsAre;
using ::testing::Pair;

constexpr int kPipeline = 3;
constexpr std::array kActions = {GriAction::kHecInit, GriAction::kHecSetPose,
                                 GriAction::kHecCalibrate};

// Returns scripted results.
class FakeCalibrator : public RobotCalibrator {
 public:
  absl::Status Check(int pipeline) override {
    return pipeline == kPipeline ? absl::OkStatus() : absl::NotFoundError("no such pipeline");
  }
  absl::Status Init(int /*pipeline*/) override { return answer; }
  absl::Status SetPose(int /*pipeline*/, int slot, const Pose& base_flange) override {
    poses.emplace_back(slot, base_flange.translation().x());
    return answer;
  }
  absl::StatusOr<CalibrationReport> Calibrate(int /*pipeline*/) override {
    if (!answer.ok()) return answer;
    return report;
  }

  absl::Status answer;
  CalibrationReport report;
  std::vector<std::pair<int, double>> poses;
};

GriRequest RequestOf(GriAction action, int pipeline = kPipeline, int slot = 0) {
  GriRequest out;
  out.action = static_cast<std::uint8_t>(action);
  out.pose_format = kQuaternionXyzw;
  Pose flange = Pose::Identity();
  flange.translation().x() = 0.25;
  out.pose = *ToGriPose(flange, out.pose_format);
  out.data[0] = pipeline;
  out.data[1] = slot;
  return out;
}

class GriHandEyeTest : public ::testing::Test {
 protected:
  GriCode Call(GriAction action, int pipeline = kPipeline, int slot = 0) {
    return hand_eye_.Answer(RequestOf(action, pipeline, slot)).code;
  }

  FakeCalibrator calibrator_;
  GriHandEye hand_eye_{&calibrator_};
};

TEST_F(GriHandEyeTest, SetsPosesInSlots) {
  EXPECT_EQ(Call(GriAction::kHecSetPose, kPipeline, 0), GriCode::kNoError);
  EXPECT_EQ(Call(GriAction::kHecSetPose, kPipeline, 8), GriCode::kNoError);
  EXPECT_THAT(calibrator_.poses, ElementsAre(Pair(0, 0.25), Pair(8, 0.25)));
}

TEST_F(GriHandEyeTest, InvalidSlotsAndPosesAreInvalidRequests) {
  for (const int slot : {-1, 9, 1'000'000}) {
    EXPECT_EQ(Call(GriAction::kHecSetPose, kPipeline, slot), GriCode::kInvalidRequest) << slot;
  }
  GriRequest request = RequestOf(GriAction::kHecSetPose);
  request.pose = {};
  for (int format = kQuaternionWxyz; format <= kLastPoseFormat; ++format) {
    request.pose_format = static_cast<std::uint8_t>(format);
    EXPECT_EQ(hand_eye_.Answer(request).code, GriCode::kInvalidRequest) << format;
  }
  EXPECT_TRUE(calibrator_.poses.empty());
}

TEST_F(GriHandEyeTest, ReturnsTheResiduals) {
  calibrator_.report = {
      .shift_m = 0.0012345, .turn_rad = 0.25 * std::numbers::pi / 180, .used = 7, .poses = 8};
  const GriResponse answer = hand_eye_.Answer(RequestOf(GriAction::kHecCalibrate));
  EXPECT_EQ(answer.code, GriCode::kNoError);
  EXPECT_EQ(answer.action, 9);
  EXPECT_EQ(answer.pose_format, kQuaternionXyzw);
  EXPECT_THAT(answer.data, ElementsAre(0, 1'234'500, 250'000, 7, 0, 0, 0, 0, 0, 0));
}

TEST_F(GriHandEyeTest, LargeResidualsSaturate) {
  calibrator_.report.shift_m = 1000;
  EXPECT_EQ(hand_eye_.Answer(RequestOf(GriAction::kHecCalibrate)).data[1], 2'147'483'647);
}

TEST_F(GriHandEyeTest, AMissingPipelineIsAnErrorForEveryAction) {
  GriHandEye without(nullptr);
  for (const GriAction action : kActions) {
    EXPECT_EQ(Call(action, kPipeline + 1), GriCode::kPipelineNotAvailable);
    EXPECT_EQ(without.Answer(RequestOf(action)).code, GriCode::kPipelineNotAvailable);
  }
}

// Waits in SetPose until `go_on`.
class WaitingCalibrator : public FakeCalibrator {
 public:
  absl::Status SetPose(int /*pipeline*/, int /*slot*/, const Pose& /*base_flange*/) override {
    begun.Notify();
    go_on.WaitForNotification();
    return absl::OkStatus();
  }
  absl::Notification begun;
  absl::Notification go_on;
};

TEST(GriHandEyeTurnsTest, ARequestDoesNotWaitForTheLastOneOfItsPipeline) {
  WaitingCalibrator calibrator;
  GriHandEye hand_eye(&calibrator);
  std::thread slow([&] {
    EXPECT_EQ(hand_eye.Answer(RequestOf(GriAction::kHecSetPose)).code, GriCode::kNoError);
  });
  calibrator.begun.WaitForNotification();
  for (const GriAction action : kActions) {
    EXPECT_NE(hand_eye.Answer(RequestOf(action)).code, GriCode::kNoError);
  }
  calibrator.go_on.Notify();
  slow.join();
  EXPECT_EQ(hand_eye.Answer(RequestOf(GriAction::kHecInit)).code, GriCode::kNoError);
}

TEST_F(GriHandEyeTest, EveryErrorHasItsCode) {
  const auto code_of = [&](absl::Status error, GriAction action) {
    calibrator_.answer = std::move(error);
    return Call(action);
  };
  for (const GriAction action : kActions) {
    EXPECT_EQ(code_of(absl::NotFoundError(""), action), GriCode::kHecInsufficientDetection);
    EXPECT_EQ(code_of(absl::FailedPreconditionError(""), action), GriCode::kHecConfigError);
    EXPECT_EQ(code_of(absl::UnavailableError(""), action), GriCode::kApiNotReachable);
    EXPECT_EQ(code_of(absl::DataLossError(""), action), GriCode::kPipelineNotAvailable);
    EXPECT_EQ(code_of(absl::DeadlineExceededError(""), action), GriCode::kProcessingTimeout);
  }
  EXPECT_EQ(code_of(absl::AbortedError(""), GriAction::kHecInit), GriCode::kHecInitError);
  EXPECT_EQ(code_of(absl::AbortedError(""), GriAction::kHecSetPose), GriCode::kHecSetPoseError);
  EXPECT_EQ(code_of(absl::InternalError(""), GriAction::kHecCalibrate),
            GriCode::kHecCalibrateError);
}

TEST(GriProtocolTest, HandEyeActionsDoNotNeedAJob) {
  ScriptedRunner runner;  // without jobs
  GriJobs jobs(runner);
  FakeCalibrator calibrator;
  GriProtocol with(jobs, &calibrator);
  GriProtocol without(jobs);
  const auto code_of = [](const RobotReply& reply) {
    std::array<std::uint8_t, kGriResponseBytes> bytes = {};
    std::ranges::copy(reply.bytes, bytes.begin());
    return ParseGriResponse(bytes)->code;
  };
  for (const GriAction action : kActions) {
    const auto bytes = GriBytes(RequestOf(action));
    const std::string message(bytes.begin(), bytes.end());
    EXPECT_EQ(code_of(with.Answer("r", message)), GriCode::kNoError);
    EXPECT_EQ(code_of(without.Answer("r", message)), GriCode::kPipelineNotAvailable);
  }
}

}  // namespace
}  // namespace graspdb::client
