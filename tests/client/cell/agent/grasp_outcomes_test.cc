#include "client/cell/agent/jobs/cell_runner.h"
#include "program/base/uuid.h"
#include "tests/client/cell/agent/cell_runner_fixture.h"
#include "tests/testing/busy_status.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using recognition::Pose;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST_F(CellRunnerTest, AShownGraspUsesThePreviousDetection) {
  ASSERT_THAT(Run(1), IsOk());
  // The gripper occludes the object now: nothing is detected.
  server_.Change([](ScriptedServer& server) {
    server.recognize = [](const v1::RecognizeRequest&, v1::RecognizeResponse*) {
      return grpc::Status::OK;
    };
  });
  const Pose down(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()));
  const auto shown = Run(80, AtXZ(1.25, 0.05) * down);
  ASSERT_THAT(shown, IsOk());
  EXPECT_THAT(*shown, IsEmpty());
  ASSERT_EQ(server_.stable_pose.grasps_size(), 2);
  const v1::Grasp& side = server_.stable_pose.grasps(1);
  EXPECT_EQ(side.grasp_id(), "side");
  EXPECT_TRUE(files::FromMessage(side.tcp_pose()).isApprox(AtXZ(0.05, 0.05) * down, 1e-9));
}

TEST_F(CellRunnerTest, AfterAnOutcomeAShownGraspNeedsANewDetection) {
  session_.SetGiven(Run(1)->front());
  ASSERT_THAT(runner_.ReportOutcome(session_, PickOutcome::kPicked), IsOk());
  server_.Change([](ScriptedServer& server) {
    server.recognize = [](const v1::RecognizeRequest&, v1::RecognizeResponse*) {
      return grpc::Status::OK;
    };
  });
  const Pose down(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()));
  EXPECT_THAT(Run(80, AtXZ(1.25, 0.05) * down),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("nothing")));
}

TEST_F(CellRunnerTest, WithAFlangeCameraAGraspIsShownAfterARecognisingJob) {
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell* cell) {
      *cell->mutable_flange_sensor_pose() = files::ToMessage(AtXZ(0));
      return grpc::Status::OK;
    };
  });
  ASSERT_THAT(cache_.Refresh(), IsOk());
  const Pose down(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()));
  EXPECT_THAT(Run(80, AtXZ(0.25, 0.05) * down),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("recognising job first")));
  ASSERT_THAT(Run(1), IsOk());
  EXPECT_THAT(Run(80, AtXZ(0.25, 0.05) * down), IsOk());
}

TEST_F(CellRunnerTest, ShowingAGraspRequiresAPose) {
  EXPECT_THAT(Run(80, std::nullopt), StatusIs(absl::StatusCode::kInvalidArgument));
}

TEST_F(CellRunnerTest, ShowingAGraspAwayFromObjectsIsAnInvalidRequest) {
  EXPECT_THAT(Run(80, AtXZ(9)), StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("nothing")));
  EXPECT_THAT(Run(80, AtXZ(1.2, -0.1)),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("below the table")));
}

TEST_F(CellRunnerTest, RejectionsByTheServerAreDataLoss) {
  ASSERT_THAT(Run(1), IsOk());
  const Pose down(Eigen::AngleAxisd(3.141592653589793, Eigen::Vector3d::UnitX()));
  server_.Change([](ScriptedServer& server) {
    server.stable_pose.set_name("objects/mug/stablePoses/another");
    server.report_outcome = [](const v1::ReportGraspOutcomeRequest& /*request*/) {
      return grpc::Status(grpc::StatusCode::NOT_FOUND, "no such grasp");
    };
    server.list_objects = [](v1::ListObjectsResponse* /*response*/) {
      return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "not you");
    };
  });
  EXPECT_THAT(Run(80, AtXZ(1.25, 0.05) * down),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("no such pose")));
  EXPECT_THAT(Run(2), StatusIs(absl::StatusCode::kDataLoss, HasSubstr("PERMISSION_DENIED")));
  session_.SetGiven(Run(1)->front());
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kMissed),
              StatusIs(absl::StatusCode::kDataLoss, HasSubstr("no such grasp")));
}

TEST_F(CellRunnerTest, ABusyServerIsUnavailableForOutcomesAndLabels) {
  const auto given = *Run(1);
  server_.Change([](ScriptedServer& server) {
    server.report_outcome = [](const v1::ReportGraspOutcomeRequest& /*request*/) {
      return testing::BusyFor(absl::Milliseconds(1));
    };
    server.list_objects = [](v1::ListObjectsResponse* /*response*/) {
      return testing::BusyFor(absl::Milliseconds(1));
    };
  });
  EXPECT_THAT(Run(2), StatusIs(absl::StatusCode::kUnavailable, HasSubstr("the queue is full")));
  session_.SetGiven(given.front());
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kMissed),
              StatusIs(absl::StatusCode::kUnavailable, HasSubstr("the queue is full")));
}

TEST_F(CellRunnerTest, APoseGivenWhileReportingFailsIsReportedNext) {
  const auto given = *Run(1);
  JobPose newer = given.front();
  newer.grasp.set_grasp_id("handle");
  std::string reported;
  server_.Change([&](ScriptedServer& server) {
    server.report_outcome = [&](const v1::ReportGraspOutcomeRequest& request) {
      reported = request.grasp_id();
      if (reported == "handle") return grpc::Status::OK;
      session_.SetGiven(newer);
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    };
  });
  session_.SetGiven(given.front());
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kMissed),
              StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kPicked), IsOk());
  EXPECT_EQ(reported, "handle");
}

TEST_F(CellRunnerTest, AnOutcomeRefersToTheLastPoseOnce) {
  v1::ReportGraspOutcomeRequest reported;
  server_.Change([&](ScriptedServer& server) {
    server.report_outcome = [&](const v1::ReportGraspOutcomeRequest& request) {
      reported = request;
      return grpc::Status::OK;
    };
  });
  EXPECT_THAT(Run(90), StatusIs(absl::StatusCode::kFailedPrecondition));
  session_.SetGiven(Run(1)->front());
  EXPECT_THAT(Run(90), IsOk());
  EXPECT_EQ(reported.name(), "objects/mug/stablePoses/upright");
  EXPECT_EQ(reported.grasp_id(), "rim");
  EXPECT_EQ(reported.outcome(), v1::GRASP_OUTCOME_PICKED);
  EXPECT_THAT(counters_.Text(), HasSubstr("picked=1"));
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kPicked),
              StatusIs(absl::StatusCode::kFailedPrecondition));
}

TEST_F(CellRunnerTest, ARepeatedOutcomeHasTheIdOfTheOneThatFailed) {
  std::vector<std::string> ids;
  server_.Change([&](ScriptedServer& server) {
    server.report_outcome = [&](const v1::ReportGraspOutcomeRequest& request) {
      ids.push_back(request.request_id());
      return ids.size() < 4 ? grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone")
                            : grpc::Status::OK;
    };
  });
  const auto report = [&](PickOutcome outcome) { return runner_.ReportOutcome(session_, outcome); };
  session_.SetGiven(Run(1)->front());
  EXPECT_FALSE(report(PickOutcome::kMissed).ok());
  EXPECT_FALSE(report(PickOutcome::kMissed).ok());
  EXPECT_FALSE(report(PickOutcome::kPicked).ok());
  EXPECT_THAT(report(PickOutcome::kPicked), IsOk());
  session_.SetGiven(Run(1)->front());
  EXPECT_THAT(report(PickOutcome::kPicked), IsOk());
  ASSERT_THAT(ids, SizeIs(5));
  EXPECT_TRUE(IsUuid4(ids[0])) << ids[0];
  EXPECT_EQ(ids[1], ids[0]);
  EXPECT_NE(ids[2], ids[0]) << "another outcome";
  EXPECT_EQ(ids[3], ids[2]);
  EXPECT_NE(ids[4], ids[3]) << "another pose";
}

TEST_F(CellRunnerTest, AFailedOutcomeMayBeRetried) {
  const auto answer_with = [this](grpc::StatusCode code) {
    server_.Change([code](ScriptedServer& server) {
      server.report_outcome = [code](const v1::ReportGraspOutcomeRequest& /*request*/) {
        return grpc::Status(code, "scripted status");
      };
    });
  };
  session_.SetGiven(Run(1)->front());
  answer_with(grpc::StatusCode::UNAVAILABLE);
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kMissed),
              StatusIs(absl::StatusCode::kUnavailable));
  answer_with(grpc::StatusCode::OK);
  EXPECT_THAT(runner_.ReportOutcome(session_, PickOutcome::kMissed), IsOk());
}

}  // namespace
}  // namespace graspdb::client
