#include "client/cell/agent/jobs/cell_runner.h"

#include <functional>
#include <utility>

#include "client/cell/blackbox/replay.h"
#include "tests/client/cell/agent/cell_runner_fixture.h"
#include "tests/testing/busy_status.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {
namespace {

using graspdb::testing::IsOk;
using graspdb::testing::StatusIs;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

TEST_F(CellRunnerTest, ReturnsGraspsInTheRobotsBaseFrame) {
  const auto poses = Run(1);
  ASSERT_THAT(poses, IsOk());
  ASSERT_THAT(*poses, SizeIs(1));
  EXPECT_TRUE(poses->front().base_primary.isApprox(AtXZ(1.2, 0.1)));
  EXPECT_TRUE(poses->front().base_related[0].isApprox(AtXZ(1.2)));
  EXPECT_EQ(poses->front().grasp.grasp_id(), "rim");
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
  EXPECT_EQ(poses->front().grasp.grasp_id(), "rim");
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

TEST_F(CellRunnerTest, LabelsAreReadAgainAfterAnOlderCatalogueWasRestored) {
  EXPECT_THAT(*Run(2), SizeIs(1));
  server_.Change([](ScriptedServer& server) {
    server.recognize = [](const v1::RecognizeRequest& request, v1::RecognizeResponse* out) {
      grpc::Status status = MugOnTheTable(request, out);
      out->set_catalog_revision(3);
      return status;
    };
    server.list_objects = [](v1::ListObjectsResponse* response) {
      v1::Object* mug = response->add_objects();
      mug->set_name("objects/mug");
      mug->add_labels("plates");
      return grpc::Status::OK;
    };
  });
  EXPECT_THAT(*Run(2), IsEmpty());
  EXPECT_THAT(*Run(3), SizeIs(1));
}

TEST_F(CellRunnerTest, LabelsAreReadAgainWhereARestoredCatalogueHasTheSameRevision) {
  for (const char* catalogue : {"original", "restored", "restored"}) {
    server_.Change([catalogue](ScriptedServer& server) {
      server.recognize = [catalogue](const v1::RecognizeRequest& request,
                                     v1::RecognizeResponse* out) {
        out->set_catalog_id(catalogue);
        return MugOnTheTable(request, out);
      };
    });
    EXPECT_THAT(*Run(2), SizeIs(1));
  }
  EXPECT_EQ(listed_, 2);
}

TEST_F(CellRunnerTest, RespectsTheWorkspaceOfTheCell) {
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell* cell) {
      *cell->mutable_sensor_pose() = files::ToMessage(AtXZ(0));
      cell->mutable_workspace()->mutable_max()->set_x(0.1);
      cell->mutable_workspace()->mutable_max()->set_y(1);
      cell->mutable_workspace()->mutable_max()->set_z(1);
      return grpc::Status::OK;
    };
  });
  ASSERT_THAT(cache_.Refresh(), IsOk());
  EXPECT_THAT(*Run(1), IsEmpty());
}

TEST_F(CellRunnerTest, ARobotGetsTheReasonForNoPoseOnce) {
  EXPECT_THAT(*Run(3), IsEmpty());
  session_.EndRun(3, std::vector<JobPose>());
  const JobAnswer first = session_.Next(3, /*returns_poses=*/true);
  EXPECT_EQ(first.code, GriCode::kNoPosesFound);
  EXPECT_THAT(first.why, HasSubstr("objects/mug lacks the label plates"));
  EXPECT_EQ(reports_.back().no_pose_reason, first.why);
  EXPECT_THAT(session_.Next(3, /*returns_poses=*/true).why, HasSubstr("no pose left"));
}

TEST_F(CellRunnerTest, AnInvalidPoseOfTheRobotIsNoMissingOne) {
  const JobRequest request = {.job = 80, .session = session_, .pose_fault = "the length is 2"};
  EXPECT_THAT(runner_.Run(request),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("the length is 2")));
  server_.Change([](ScriptedServer& server) {
    server.get_cell = [](v1::Cell* cell) {
      *cell->mutable_flange_sensor_pose() = files::ToMessage(AtXZ(0));
      return grpc::Status::OK;
    };
  });
  ASSERT_THAT(cache_.Refresh(), IsOk());
  EXPECT_THAT(runner_.Run({.job = 1, .session = session_, .pose_fault = "the length is 2"}),
              StatusIs(absl::StatusCode::kInvalidArgument, HasSubstr("the length is 2")));
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

TEST_F(CellRunnerTest, IsReadyWithTheFirstAnswerAfterAnOutage) {
  ASSERT_THAT(cache_.Refresh(), IsOk());
  std::function<grpc::Status(v1::Cell*)> there;
  server_.Change([&](ScriptedServer& server) {
    there = std::exchange(server.get_cell, [](v1::Cell*) {
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "gone");
    });
  });
  EXPECT_THAT(cache_.Refresh(), StatusIs(absl::StatusCode::kUnavailable));
  EXPECT_FALSE(runner_.IsReady());
  server_.Change([&](ScriptedServer& server) { server.get_cell = there; });
  ASSERT_THAT(Run(1), IsOk());
  EXPECT_TRUE(runner_.IsReady());
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
  const std::optional<v1::Bundle> bundle = BundleOf(reports_[0], "9.8");
  ASSERT_TRUE(bundle);
  EXPECT_EQ(bundle->request_id(), received[0]);
}

TEST_F(CellRunnerTest, ABundleHasTheAnswerOfTheServer) {
  server_.Change([](ScriptedServer& server) {
    server.list_objects = [](v1::ListObjectsResponse* /*response*/) {
      return grpc::Status(grpc::StatusCode::PERMISSION_DENIED, "not you");
    };
  });
  EXPECT_THAT(Run(2), StatusIs(absl::StatusCode::kDataLoss));
  server_.Change([](ScriptedServer& server) {
    server.recognize = [](const v1::RecognizeRequest&, v1::RecognizeResponse*) {
      return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "the scan is empty");
    };
  });
  EXPECT_THAT(Run(1), StatusIs(absl::StatusCode::kDataLoss));
  ASSERT_THAT(reports_, SizeIs(2));
  v1::RecognizeResponse mug;
  ASSERT_TRUE(MugOnTheTable({}, &mug).ok());
  EXPECT_TRUE(CompareReplay(*BundleOf(reports_[0], "9.8"), mug).is_same);
  EXPECT_TRUE(
      CompareReplay(*BundleOf(reports_[1], "9.8"), absl::InvalidArgumentError("the scan is empty"))
          .is_same);
}

TEST_F(CellRunnerTest, ABundleHasTheLastKnownRevisionAndTheServersVersion) {
  ASSERT_THAT(Run(1), IsOk());
  server_.Change([](ScriptedServer& server) {
    server.recognize = [](const v1::RecognizeRequest&, v1::RecognizeResponse*) {
      return grpc::Status(grpc::StatusCode::INVALID_ARGUMENT, "the scan is empty");
    };
  });
  EXPECT_THAT(Run(1), StatusIs(absl::StatusCode::kDataLoss));
  ASSERT_THAT(reports_, SizeIs(2));
  for (const JobReport& report : reports_) {
    const std::optional<v1::Bundle> bundle = BundleOf(report, "9.8");
    ASSERT_TRUE(bundle);
    EXPECT_EQ(bundle->catalog_revision(), 7);
    EXPECT_EQ(bundle->server_version(), "9.8");
  }
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
  EXPECT_EQ(value("graspdb_cell_empty_jobs_total", {"cells/press-3", "1"}), 0);
  EXPECT_EQ(value("graspdb_cell_empty_jobs_total", {"cells/press-3", "3"}), 1);
  const auto picks = [&](const char* outcome) {
    return value("graspdb_cell_picks_total", {"cells/press-3", "objects/mug", outcome});
  };
  EXPECT_EQ(picks("GRASP_OUTCOME_SLIPPED"), 1);
  EXPECT_EQ(picks("GRASP_OUTCOME_MISSED"), 0);
  EXPECT_GE(value("graspdb_cell_frame_age_seconds", {"cells/press-3"}), 0);
}

}  // namespace
}  // namespace graspdb::client
