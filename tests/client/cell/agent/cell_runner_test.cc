#include "client/cell/agent/cell_runner.h"

#include <gmock/gmock.h>

#include <atomic>

#include "client/cell/agent/cell_metrics.h"
#include "client/cell/agent/job_bundle.h"
#include "client/cell/robots/robot_session.h"
#include "files/pose_message.h"
#include "program/uuid.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/client/cell/agent/scripted_server.h"
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

Pose AtXZ(double x, double z = 0) { return Pose(Eigen::Translation3d(x, 0, z)); }

grpc::Status MugOnTheTable(const v1::RecognizeRequest& /*request*/, v1::RecognizeResponse* out) {
  out->set_catalog_revision(7);
  v1::Detection* mug = out->add_detections();
  mug->set_status(v1::OK);
  mug->set_object("objects/mug");
  mug->set_stable_pose("objects/mug/stablePoses/upright");
  mug->set_score(0.9);
  *mug->mutable_refined_pose() = ToMessage(AtXZ(0.2));
  mug->mutable_centroid()->set_x(0.2);
  v1::GraspProposal* grasp = mug->add_grasps();
  grasp->set_grasp_id("rim");
  *grasp->mutable_tcp_pose() = ToMessage(AtXZ(0.2, 0.1));
  return grpc::Status::OK;
}

class CellRunnerTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::vector<JobPose>> Run(int job, const std::optional<Pose>& flange = AtXZ(0)) {
    return runner_.Run({.job = job, .session = session_, .base_flange = flange});
  }

  // Called before the first request.
  Client Script() {
    server_.Change([this](ScriptedServer& server) {
      server.recognize = MugOnTheTable;
      server.get_cell = [](v1::Cell* cell) {
        *cell->mutable_sensor_pose() = ToMessage(AtXZ(0));
        *cell->mutable_robot_base_pose() = ToMessage(AtXZ(-1));
        return grpc::Status::OK;
      };
      server.list_objects = [this](v1::ListObjectsResponse* response) {
        ++listed_;
        v1::Object* mug = response->add_objects();
        mug->set_name("objects/mug");
        mug->add_labels("cups");
        return grpc::Status::OK;
      };
      server.stable_pose.set_name("objects/mug/stablePoses/upright");
      server.stable_pose.set_etag("1");
      server.stable_pose.add_grasps()->set_grasp_id("rim");
    });
    return server_.Connect();
  }

  std::atomic<int> listed_ = 0;
  ScriptedServer server_;
  Client client_ = Script();
  FakeCamera camera_{[]() -> absl::StatusOr<SensorFrame> {
    return SensorFrame{.scan = v1::DepthImage(), .time = absl::Now(), .world_sensor = {}};
  }};
  CellCache cache_{client_, "cells/press-3", absl::Hours(1)};
  CaptureAndRecognize capture_and_recognize_{camera_, client_, cache_, "cells/press-3"};
  Counters counters_;
  CellMetrics metrics_{"cells/press-3"};
  std::vector<JobReport> reports_;
  RobotSession session_{"r"};
  CellRunner runner_{*ParseJobs({"1 any", "2 label=cups", "3 label=plates", "4 any protocol=line",
                                 "80 show=side", "90 outcome=picked"}),
                     JobProtocol::kGri,
                     {},
                     {camera_, client_, cache_, capture_and_recognize_, counters_, "cells/press-3",
                      [this](const JobReport& report) { reports_.push_back(report); }, &metrics_}};
};

TEST_F(CellRunnerTest, ReturnsGraspsInTheRobotsBaseFrame) {
  const auto poses = Run(1);
  ASSERT_THAT(poses, IsOk());
  ASSERT_THAT(*poses, SizeIs(1));
  EXPECT_TRUE(poses->front().base_primary.isApprox(AtXZ(1.2, 0.1)));
  EXPECT_TRUE(poses->front().base_related[0].isApprox(AtXZ(1.2)));
  EXPECT_EQ(poses->front().grasp_id, "rim");
}

TEST_F(CellRunnerTest, ARobotGetsItsGraspThoughTheServerWasBusyAtFirst) {
  int calls = 0;
  server_.Change([&](ScriptedServer& server) {
    server.recognize = [&](const v1::RecognizeRequest& request, v1::RecognizeResponse* out) {
      return ++calls == 1 ? testing::BusyFor(absl::Milliseconds(1)) : MugOnTheTable(request, out);
    };
  });
  const auto poses = Run(1);
  ASSERT_THAT(poses, IsOk());
  ASSERT_THAT(*poses, SizeIs(1));
  EXPECT_EQ(poses->front().grasp_id, "rim");
  EXPECT_EQ(calls, 2);
}

TEST_F(CellRunnerTest, UnknownJobsAndJobsOfOtherProtocolsAreRejected) {
  EXPECT_THAT(runner_.Check(1), IsOk());
  EXPECT_THAT(runner_.Check(5), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_THAT(runner_.Check(4), StatusIs(absl::StatusCode::kPermissionDenied));
  EXPECT_THAT(Run(5), StatusIs(absl::StatusCode::kNotFound));
  EXPECT_TRUE(runner_.ReturnsPoses(1));
  EXPECT_FALSE(runner_.ReturnsPoses(90));
}

TEST_F(CellRunnerTest, LabelsAreReadOncePerRevision) {
  EXPECT_THAT(*Run(2), SizeIs(1));
  EXPECT_THAT(*Run(3), IsEmpty());
  EXPECT_EQ(listed_, 1);
}

TEST_F(CellRunnerTest, RespectsTheWorkspaceOfTheCell) {
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell* cell) {
      *cell->mutable_sensor_pose() = ToMessage(AtXZ(0));
      cell->mutable_workspace()->mutable_max()->set_x(0.1);
      cell->mutable_workspace()->mutable_max()->set_y(1);
      cell->mutable_workspace()->mutable_max()->set_z(1);
      return grpc::Status::OK;
    };
  });
  ASSERT_THAT(cache_.Refresh(), IsOk());
  EXPECT_THAT(*Run(1), IsEmpty());
}

TEST_F(CellRunnerTest, IsReadyWithCameraAndServer) {
  ASSERT_THAT(cache_.Refresh(), IsOk());
  EXPECT_TRUE(runner_.IsReady());
  camera_.ready = false;
  EXPECT_FALSE(runner_.IsReady());
  camera_.ready = true;
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell*) { return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone"); };
  });
  EXPECT_THAT(cache_.Refresh(), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE(runner_.IsReady());
}

TEST_F(CellRunnerTest, CallsTheJobCallback) {
  ASSERT_THAT(Run(1), IsOk());
  ASSERT_THAT(reports_, SizeIs(1));
  EXPECT_EQ(reports_[0].request.session.robot(), "r");
  EXPECT_THAT(reports_[0].status, IsOk());
  EXPECT_EQ(reports_[0].capture.response.catalog_revision(), 7);
  EXPECT_THAT(reports_[0].poses, SizeIs(1));
  EXPECT_THAT(counters_.Text(), HasSubstr("jobs=1 with_pose=1"));
}

TEST_F(CellRunnerTest, SendsTheRequestIdThatItReports) {
  std::vector<std::string> received;
  server_.Change([&](ScriptedServer& server) {
    server.recognize_id = [&](const std::string& id) { received.push_back(id); };
  });
  ASSERT_THAT(Run(1), IsOk());
  ASSERT_THAT(reports_, SizeIs(1));
  EXPECT_THAT(received, ::testing::ElementsAre(reports_[0].capture.request_id));
  const std::optional<v1::Bundle> bundle = BundleOf(reports_[0]);
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->request_id(), received[0]);
}

TEST_F(CellRunnerTest, CountsJobsAndPicksForMetrics) {
  ASSERT_THAT(Run(1), IsOk());
  ASSERT_THAT(Run(3), IsOk());
  session_.SetGiven(*Run(1)->begin());
  ASSERT_THAT(runner_.ReportOutcome(session_, PickOutcome::kSlipped), IsOk());
  const auto value = [&](const std::string& name, const std::vector<std::string>& labels) {
    for (const prometheus::MetricFamily& family : metrics_.Collect({})) {
      if (family.name != name) continue;
      for (const prometheus::ClientMetric& metric : family.metric) {
        std::vector<std::string> values;
        for (const auto& label : metric.label) values.push_back(label.value);
        if (values == labels) return metric.counter.value + metric.gauge.value;
      }
    }
    return -1.0;
  };
  EXPECT_EQ(value("graspdb_cell_jobs_total", {"cells/press-3", "1", "OK"}), 2);
  EXPECT_EQ(value("graspdb_cell_empty_jobs_total", {"cells/press-3", "3"}), 1);
  EXPECT_EQ(
      value("graspdb_cell_picks_total", {"cells/press-3", "objects/mug", "GRASP_OUTCOME_SLIPPED"}),
      1);
  EXPECT_GE(value("graspdb_cell_frame_age_seconds", {"cells/press-3"}), 0);
}

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
  EXPECT_TRUE(FromMessage(side.tcp_pose()).isApprox(AtXZ(0.05, 0.05) * down, 1e-9));
}

TEST_F(CellRunnerTest, WithAFlangeCameraAGraspIsShownAfterARecognisingJob) {
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell* cell) {
      *cell->mutable_flange_sensor_pose() = ToMessage(AtXZ(0));
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

TEST_F(CellRunnerTest, APoseGivenWhileReportingFailsIsReportedNext) {
  const auto given = *Run(1);
  JobPose newer = given.front();
  newer.grasp_id = "handle";
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
