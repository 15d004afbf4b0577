// A cell runner with a camera and a server of the tests.
#pragma once

#include <gmock/gmock.h>

#include <atomic>
#include <vector>

#include "client/cell/agent/jobs/cell_metrics.h"
#include "client/cell/agent/jobs/cell_runner.h"
#include "client/cell/robots/robot_session.h"
#include "files/messages/pose_message.h"
#include "tests/client/cell/agent/fake_camera.h"
#include "tests/client/cell/agent/scripted_server.h"

namespace graspdb::client {

inline recognition::Pose AtXZ(double x, double z = 0) {
  return recognition::Pose(Eigen::Translation3d(x, 0, z));
}

inline grpc::Status MugOnTheTable(const v1::RecognizeRequest& /*request*/,
                                  v1::RecognizeResponse* out) {
  out->set_catalog_revision(7);
  v1::Detection* mug = out->add_detections();
  mug->set_status(v1::OK);
  mug->set_object("objects/mug");
  mug->set_stable_pose("objects/mug/stablePoses/upright");
  mug->set_score(0.9);
  *mug->mutable_refined_pose() = files::ToMessage(AtXZ(0.2));
  mug->mutable_centroid()->set_x(0.2);
  v1::GraspProposal* grasp = mug->add_grasps();
  grasp->mutable_grasp()->set_grasp_id("rim");
  *grasp->mutable_tcp_pose() = files::ToMessage(AtXZ(0.2, 0.1));
  return grpc::Status::OK;
}

class CellRunnerTest : public ::testing::Test {
 protected:
  absl::StatusOr<std::vector<JobPose>> Run(
      int job, const std::optional<recognition::Pose>& flange = AtXZ(0)) {
    return runner_.Run({.job = job, .session = session_, .base_flange = flange});
  }

  // Called before the first request.
  Client Script() {
    server_.Change([this](ScriptedServer& server) {
      server.recognize = MugOnTheTable;
      server.get_cell = [](v1::Cell* cell) {
        *cell->mutable_sensor_pose() = files::ToMessage(AtXZ(0));
        *cell->mutable_robot_base_pose() = files::ToMessage(AtXZ(-1));
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
    return SensorFrame{.scan = v1::DepthImage(), .time = MonotonicTime::Now(), .world_sensor = {}};
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

}  // namespace graspdb::client
