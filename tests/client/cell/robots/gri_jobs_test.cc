#include <gmock/gmock.h>

#include <thread>

#include "client/cell/robots/gri/gri_protocol.h"
#include "tests/client/cell/robots/fake_job_runner.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using recognition::Pose;
using ::testing::ElementsAre;
using ::testing::Pair;
using ::testing::Test;

constexpr int kJob = kFakeJob;

Pose At(double x_m) {
  Pose out = Pose::Identity();
  out.translation().x() = x_m;
  return out;
}

class GriJobsTest : public Test {
 protected:
  GriResponse Call(GriAction action, const std::string& robot = "r", int job = kJob) {
    GriRequest request;
    request.pose_format = kQuaternionXyzw;
    request.action = static_cast<std::uint8_t>(action);
    request.job_id = static_cast<std::uint16_t>(job);
    request.pose = *ToGriPose(At(0.25), kQuaternionXyzw);
    return jobs_.Answer(robot, request);
  }

  // Two grasps, the first with two related poses.
  void FindTwo() {
    runner_.found = std::vector<JobPose>{{At(0.1), {At(0.11), At(0.12)}}, {At(0.2), {}}};
  }

  void AwaitStatus(GriJobStatus status, const std::string& robot = "r") {
    while (Call(GriAction::kGetJobStatus, robot).data[1] != static_cast<int>(status)) {
      std::this_thread::yield();
    }
  }

  static double MillimetresOf(const GriResponse& response) {
    return response.pose.position[0] / 1e6;
  }

  FakeJobRunner runner_;
  GriJobs jobs_{runner_};
};

TEST_F(GriJobsTest, StatusReportsWhetherTheCellIsReady) {
  EXPECT_EQ(Call(GriAction::kStatus).data[1], 1);
  runner_.ready = false;
  const GriResponse answer = Call(GriAction::kStatus, "r", /*job=*/0);
  EXPECT_EQ(answer.code, GriCode::kNoError);
  EXPECT_EQ(answer.data[1], 0);
}

TEST_F(GriJobsTest, ATriggerReturnsTheFirstPoseAndTheNumberLeft) {
  FindTwo();
  const GriResponse answer = Call(GriAction::kTriggerJobSync);
  EXPECT_EQ(answer.code, GriCode::kNoError);
  EXPECT_EQ(answer.action, 2);
  EXPECT_EQ(answer.job_id, kJob);
  EXPECT_EQ(answer.pose_format, kQuaternionXyzw);
  EXPECT_DOUBLE_EQ(MillimetresOf(answer), 100);
  EXPECT_EQ(answer.data[1], 1);
  EXPECT_EQ(answer.data[2], 2);
  ASSERT_TRUE(runner_.base_flange);
  EXPECT_TRUE(runner_.base_flange->isApprox(At(0.25)));
}

TEST_F(GriJobsTest, APoseHasGraspDataAndCameraTime) {
  JobPose grasp = {At(0.1), {At(0.11)}};
  grasp.grasp.set_gripper_opening_m(0.0625);
  grasp.grasp.set_approach_distance_m(0.05);
  grasp.grasp.set_retreat_distance_m(0.1);
  grasp.score = 0.75;
  grasp.camera_s = 0.033;
  runner_.found = std::vector<JobPose>{grasp};
  for (const GriAction action : {GriAction::kTriggerJobSync, GriAction::kGetRelatedPose}) {
    const GriResponse answer = Call(action);
    EXPECT_EQ(answer.data[3], 62'500'000);
    EXPECT_EQ(answer.data[4], 50'000'000);
    EXPECT_EQ(answer.data[5], 100'000'000);
    EXPECT_EQ(answer.data[6], 750'000);
    EXPECT_EQ(answer.data[7], 33'000);
  }
}

TEST_F(GriJobsTest, ARelatedGraspHasItsOwnData) {
  JobPose object = {At(0.1), {At(0.11), At(0.12)}};
  object.related_grasps.resize(2);
  object.related_grasps[0].set_gripper_opening_m(0.04);
  object.related_grasps[1].set_gripper_opening_m(0.08);
  object.related_grasps[1].set_approach_distance_m(0.06);
  object.related_grasps[1].set_retreat_distance_m(0.2);
  object.grasp = object.related_grasps.front();
  runner_.found = std::vector<JobPose>{object};
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).data[3], 40'000'000);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).data[3], 40'000'000);
  const GriResponse second = Call(GriAction::kGetRelatedPose);
  EXPECT_EQ(second.data[3], 80'000'000);
  EXPECT_EQ(second.data[4], 60'000'000);
  EXPECT_EQ(second.data[5], 200'000'000);
}

TEST_F(GriJobsTest, LargeNumbersSaturate) {
  JobPose grasp = {At(0.1), {}};
  grasp.grasp.set_approach_distance_m(5);
  runner_.found = std::vector<JobPose>{grasp};
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).data[4], 2'147'483'647);
}

TEST_F(GriJobsTest, AJobWithoutPosesReportsDoneOnce) {
  runner_.returns_poses = false;
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kNoPosesFound) << "it never ran";
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).code, GriCode::kNoReturnSpecified);
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kNoPosesFound);
}

TEST_F(GriJobsTest, AnUnsendablePoseIsSkippedWithItsRelatedPoses) {
  runner_.found = std::vector<JobPose>{{At(3), {At(0.1)}}, {At(0.2), {At(0.3)}}};
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).code, GriCode::kApiResponseError);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).code, GriCode::kNoRelatedPoses);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose)), 200);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetRelatedPose)), 300);
}

TEST_F(GriJobsTest, TheRunnerGetsThePoseGivenLast) {
  FindTwo();
  Call(GriAction::kTriggerJobSync, "left");
  Call(GriAction::kGetRelatedPose, "left");
  Call(GriAction::kTriggerJobSync, "right");
  Call(GriAction::kTriggerJobSync, "left");
  Call(GriAction::kGetNextPose, "left");
  Call(GriAction::kGetNextPose, "left");
  Call(GriAction::kTriggerJobSync, "left");
  EXPECT_THAT(runner_.given, ElementsAre(Pair("left", 0.1), Pair("left", 0.2)));
}

TEST_F(GriJobsTest, ANewRobotIsRefusedWhileJobsOfAllOthersRun) {
  FindTwo();
  absl::Notification go_on;
  runner_.go_on = &go_on;
  for (std::size_t i = 0; i < kMaxSessions; ++i) {
    ASSERT_EQ(Call(GriAction::kTriggerJobAsync, std::to_string(i)).code, GriCode::kNoError);
  }
  EXPECT_EQ(Call(GriAction::kTriggerJobAsync, "new").code, GriCode::kApiResponseError);
  EXPECT_EQ(Call(GriAction::kStatus, "new").data[1], 1);
  EXPECT_EQ(Call(GriAction::kGetNextPose, "0").code, GriCode::kJobStillRunning);
  go_on.Notify();
  for (std::size_t i = 0; i < kMaxSessions; ++i)
    AwaitStatus(GriJobStatus::kDone, std::to_string(i));
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kTriggerJobSync, "new")), 100);
}

TEST_F(GriJobsTest, RelatedPosesBelongToTheLastPrimary) {
  FindTwo();
  Call(GriAction::kTriggerJobSync);
  const GriResponse first = Call(GriAction::kGetRelatedPose);
  EXPECT_DOUBLE_EQ(MillimetresOf(first), 110);
  EXPECT_EQ(first.data[1], 1);
  EXPECT_EQ(first.data[2], 1);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetRelatedPose)), 120);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).code, GriCode::kNoRelatedPoses);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose)), 200);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).code, GriCode::kNoRelatedPoses);
}

TEST_F(GriJobsTest, ANewPrimaryDiscardsThePreviousRelatedPoses) {
  FindTwo();
  Call(GriAction::kTriggerJobSync);
  const GriResponse second = Call(GriAction::kGetNextPose);
  EXPECT_EQ(second.data[1], 0);
  EXPECT_EQ(second.data[2], 0);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).code, GriCode::kNoRelatedPoses);
}

TEST_F(GriJobsTest, AfterTheLastPoseTheJobIsReset) {
  FindTwo();
  Call(GriAction::kTriggerJobSync);
  Call(GriAction::kGetNextPose);
  EXPECT_EQ(Call(GriAction::kGetJobStatus).data[1], static_cast<int>(GriJobStatus::kDone));
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kNoPosesFound);
  EXPECT_EQ(Call(GriAction::kGetJobStatus).data[1], static_cast<int>(GriJobStatus::kInactive));
}

TEST_F(GriJobsTest, ATriggerReportsAnEmptyResult) {
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).code, GriCode::kNoPosesFound);
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kNoPosesFound);
}

TEST_F(GriJobsTest, AnAsynchronousJobRunsInTheBackground) {
  FindTwo();
  absl::Notification go_on;
  runner_.go_on = &go_on;
  EXPECT_EQ(Call(GriAction::kTriggerJobAsync).code, GriCode::kNoError);
  EXPECT_EQ(Call(GriAction::kGetJobStatus).data[1], static_cast<int>(GriJobStatus::kRunning));
  for (const GriAction action : {GriAction::kTriggerJobSync, GriAction::kTriggerJobAsync,
                                 GriAction::kGetNextPose, GriAction::kGetRelatedPose}) {
    EXPECT_EQ(Call(action).code, GriCode::kJobStillRunning);
  }
  go_on.Notify();
  AwaitStatus(GriJobStatus::kDone);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose)), 100);
}

TEST_F(GriJobsTest, AFailedJobReportsItsErrorUntilTheNextTrigger) {
  runner_.found = absl::UnavailableError("the server is gone");
  EXPECT_EQ(Call(GriAction::kTriggerJobAsync).code, GriCode::kNoError);
  AwaitStatus(GriJobStatus::kFailed);
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kApiNotReachable);
  EXPECT_EQ(Call(GriAction::kGetRelatedPose).code, GriCode::kApiNotReachable);
  FindTwo();
  EXPECT_EQ(Call(GriAction::kTriggerJobSync).code, GriCode::kNoError);
}

TEST_F(GriJobsTest, ANewTriggerDiscardsPreviousResults) {
  FindTwo();
  Call(GriAction::kTriggerJobSync);
  runner_.found = std::vector<JobPose>{{At(0.3), {}}};
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kTriggerJobSync)), 300);
  EXPECT_EQ(Call(GriAction::kGetNextPose).code, GriCode::kNoPosesFound);
}

TEST_F(GriJobsTest, RobotsDoNotTakeEachOthersPoses) {
  FindTwo();
  Call(GriAction::kTriggerJobSync, "left");
  Call(GriAction::kTriggerJobSync, "right");
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose, "left")), 200);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose, "right")), 200);
}

TEST_F(GriJobsTest, AMissingJobIsAnErrorForEveryAction) {
  for (const GriAction action :
       {GriAction::kTriggerJobSync, GriAction::kTriggerJobAsync, GriAction::kGetJobStatus,
        GriAction::kGetNextPose, GriAction::kGetRelatedPose}) {
    EXPECT_EQ(Call(action, "r", 8).code, GriCode::kJobDoesNotExist);
  }
}

TEST_F(GriJobsTest, AnOutOfRangePoseDoesNotAffectTheNextOne) {
  runner_.found = std::vector<JobPose>{{At(2.2), {}}, {At(0.1), {}}};
  const GriResponse answer = Call(GriAction::kTriggerJobSync);
  EXPECT_EQ(answer.code, GriCode::kApiResponseError);
  EXPECT_EQ(answer.pose.position[0], 0);
  EXPECT_DOUBLE_EQ(MillimetresOf(Call(GriAction::kGetNextPose)), 100);
}

TEST_F(GriJobsTest, AnInvalidRobotPoseIsIgnored) {
  GriRequest request;
  request.action = static_cast<std::uint8_t>(GriAction::kTriggerJobSync);
  request.job_id = kJob;
  jobs_.Answer("r", request);  // a quaternion of zeros
  EXPECT_FALSE(runner_.base_flange);
}

TEST_F(GriJobsTest, APoseOfZerosIsMissingInEveryFormat) {
  GriRequest request;
  request.action = static_cast<std::uint8_t>(GriAction::kTriggerJobSync);
  request.job_id = kJob;
  for (int format = kQuaternionWxyz; format <= kLastPoseFormat; ++format) {
    request.pose_format = static_cast<std::uint8_t>(format);
    jobs_.Answer("r", request);
    EXPECT_FALSE(runner_.base_flange) << format;
  }
}

TEST(GriCodeTest, HasTheDocumentedName) {
  EXPECT_EQ(GriCodeName(GriCode::kNoError), "NO_ERROR");
  EXPECT_EQ(GriCodeName(GriCode::kHecInsufficientDetection), "HEC_INSUFFICIENT_DETECTION");
  EXPECT_EQ(GriCodeName(GriCode::kJobStillRunning), "JOB_STILL_RUNNING");
  EXPECT_EQ(GriCodeName(static_cast<GriCode>(99)), "UNKNOWN_ERROR");
}

TEST(GriCodeTest, EveryErrorOfAJobHasItsCode) {
  EXPECT_EQ(GriCodeOf(absl::OkStatus()), GriCode::kNoError);
  EXPECT_EQ(GriCodeOf(absl::NotFoundError("")), GriCode::kJobDoesNotExist);
  EXPECT_EQ(GriCodeOf(absl::FailedPreconditionError("")), GriCode::kMisconfiguredJob);
  EXPECT_EQ(GriCodeOf(absl::PermissionDeniedError("")), GriCode::kWrongProtocolForJob);
  EXPECT_EQ(GriCodeOf(absl::InvalidArgumentError("")), GriCode::kInvalidRequest);
  EXPECT_EQ(GriCodeOf(absl::AbortedError("")), GriCode::kPipelineNotAvailable);
  EXPECT_EQ(GriCodeOf(absl::UnavailableError("")), GriCode::kApiNotReachable);
  EXPECT_EQ(GriCodeOf(absl::DeadlineExceededError("")), GriCode::kProcessingTimeout);
  EXPECT_EQ(GriCodeOf(absl::InternalError("")), GriCode::kInternalError);
  EXPECT_EQ(GriCodeOf(absl::UnknownError("")), GriCode::kUnknownError);
  EXPECT_EQ(GriCodeOf(absl::ResourceExhaustedError("")), GriCode::kApiResponseError);
  EXPECT_EQ(GriCodeOf(absl::DataLossError("")), GriCode::kApiResponseError);
}

}  // namespace
}  // namespace graspdb::client
