// A simulated robot with an agent whose answers are scripted.
#include "lab/simulated_robot/pick_run.h"

#include <gmock/gmock.h>

#include <chrono>

#include "client/cell/robots/gri/gri_protocol.h"
#include "client/cell/robots/robot_server.h"
#include "files/messages/pose_message.h"
#include "rendering/sample_parts.h"
#include "rendering/scene_file.h"
#include "tests/client/cell/robots/scripted_runner.h"
#include "tests/files/temporary_folder.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::lab {
namespace {

using recognition::Pose;
using ::testing::HasSubstr;
using testing::IsOk;
using ::testing::SizeIs;
using testing::StatusIs;

enum Job { kGrasps = 1, kNothing = 2, kPicked = 7, kMissed = 8 };

// Reads the robot's scene and returns the grasp of its first object, moved by `off_m` along the
// tool's x axis. Jobs 7 and 8 report picks.
class SeeingRunner : public client::ScriptedRunner {
 public:
  SeeingRunner(std::filesystem::path scene, std::vector<rendering::Workpiece> parts)
      : scene_(std::move(scene)), parts_(std::move(parts)) {
    for (const int job : {kGrasps, kNothing, kPicked, kMissed}) {
      Set(job, std::vector<client::JobPose>());
    }
  }

  bool ReturnsPoses(int job) override { return job != kPicked && job != kMissed; }

  absl::StatusOr<std::vector<client::JobPose>> Run(const client::JobRequest& request) override {
    if (request.job == kPicked || request.job == kMissed) {
      if (absl::Status reported =
              ReportOutcome(request.session, request.job == kPicked ? client::PickOutcome::kPicked
                                                                    : client::PickOutcome::kMissed);
          !reported.ok()) {
        return reported;
      }
    }
    if (request.job != kGrasps) return client::ScriptedRunner::Run(request);
    const absl::StatusOr<rendering::PlannedCapture> scene = rendering::ReadScene(scene_, parts_);
    if (!scene.ok()) return scene.status();
    const rendering::Placement& placement = scene->placements.front();
    const v1::Grasp& grasp = parts_[placement.part].grasps.front();
    client::JobPose out;
    out.grasp.set_grasp_id("a");
    out.base_primary = placement.world_object * files::FromMessage(grasp.tcp_pose()) *
                       Eigen::Translation3d(off_m, 0, 0);
    return std::vector<client::JobPose>{out};
  }

  double off_m = 0;

 private:
  const std::filesystem::path scene_;
  const std::vector<rendering::Workpiece> parts_;
};

class PickRunTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto server = client::RobotServer::Start(protocol_, {});
    ASSERT_THAT(server, IsOk());
    server_ = *std::move(server);
    options_.scene = folder_.path() / "table";
    options_.picks = 3;
  }

  absl::StatusOr<std::vector<Pick>> Run() {
    auto robot = client::GriClient::Connect("127.0.0.1", server_->port(), std::chrono::minutes(1));
    if (!robot.ok()) return robot.status();
    return RunPicks(*robot, parts_, options_, [this](const Pick&) { ++picks_; });
  }

  const files::TemporaryFolder folder_;
  const std::vector<rendering::Workpiece> parts_ = {rendering::SampleParts()[0],
                                                    rendering::SampleParts()[1]};
  SeeingRunner runner_{folder_.path() / "table", parts_};
  client::GriJobs jobs_{runner_};
  client::GriProtocol protocol_{jobs_};
  std::unique_ptr<client::RobotServer> server_;
  PickRunOptions options_;
  int picks_ = 0;
};

TEST_F(PickRunTest, ReportsPicksThatHold) {
  options_.picked_job = kPicked;
  options_.missed_job = kMissed;
  const auto picks = Run();
  ASSERT_THAT(picks, IsOk());
  ASSERT_THAT(*picks, SizeIs(3));
  EXPECT_EQ(picks_, 3);
  for (std::size_t i = 0; i < 3; ++i) {
    const Pick& pick = (*picks)[i];
    EXPECT_EQ(pick.code, client::GriCode::kNoError);
    EXPECT_TRUE(pick.held);
    EXPECT_EQ(pick.shown, parts_[i % 2].object_id) << "each of the parts in turn";
    EXPECT_EQ(pick.error.object, pick.shown);
    EXPECT_LT(pick.error.shift_m, 1e-6);
  }
  ASSERT_THAT(runner_.outcomes(), SizeIs(3));
  for (const auto& [grasp, outcome] : runner_.outcomes())
    EXPECT_EQ(outcome, client::PickOutcome::kPicked);
}

TEST_F(PickRunTest, ReportsPicksThatDoNotHold) {
  runner_.off_m = 0.005;
  options_.picked_job = kPicked;
  options_.missed_job = kMissed;
  const auto picks = Run();
  ASSERT_THAT(picks, IsOk());
  for (const Pick& pick : *picks) EXPECT_FALSE(pick.held);
  ASSERT_THAT(runner_.outcomes(), SizeIs(3));
  for (const auto& [grasp, outcome] : runner_.outcomes())
    EXPECT_EQ(outcome, client::PickOutcome::kMissed);
}

TEST_F(PickRunTest, ConvertsPosesFromTheRobotBaseFrame) {
  options_.world_base = Pose(Eigen::Translation3d(0, 0, 0.1));
  const auto picks = Run();
  ASSERT_THAT(picks, IsOk());
  for (const Pick& pick : *picks) {
    EXPECT_FALSE(pick.held);
    EXPECT_NEAR(pick.error.shift_m, 0.1, 1e-6);
  }
}

TEST_F(PickRunTest, DoesNotReportRequestsWithoutAPose) {
  options_.job = kNothing;
  options_.picked_job = kPicked;
  options_.missed_job = kMissed;
  const auto picks = Run();
  ASSERT_THAT(picks, IsOk());
  ASSERT_THAT(*picks, SizeIs(3));
  for (const Pick& pick : *picks) {
    EXPECT_EQ(pick.code, client::GriCode::kNoPosesFound);
    EXPECT_FALSE(pick.held);
    EXPECT_GT(pick.latency.count(), 0);
  }
  EXPECT_THAT(runner_.outcomes(), SizeIs(0));
}

TEST_F(PickRunTest, FailsIfAJobCannotReportPicks) {
  options_.picked_job = 99;
  EXPECT_THAT(Run(), StatusIs(absl::StatusCode::kFailedPrecondition,
                              ::testing::AllOf(HasSubstr("99"), HasSubstr("JOB_DOES_NOT_EXIST"))));
  options_.picked_job = kPicked;
  runner_.Refuse(kPicked, absl::FailedPreconditionError("not so"));
  EXPECT_THAT(Run(),
              StatusIs(absl::StatusCode::kFailedPrecondition, HasSubstr("MISCONFIGURED_JOB")));
}

TEST_F(PickRunTest, ReturnsUnavailableWithoutAnAgent) {
  auto robot = client::GriClient::Connect("127.0.0.1", server_->port(), std::chrono::minutes(1));
  ASSERT_THAT(robot, IsOk());
  server_.reset();
  EXPECT_THAT(RunPicks(*robot, parts_, options_, [](const Pick&) {}),
              StatusIs(absl::StatusCode::kUnavailable));
}

}  // namespace
}  // namespace graspdb::lab
