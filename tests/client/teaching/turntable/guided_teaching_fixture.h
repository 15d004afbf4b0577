// Guided teaching with a real server, a simulated camera and a scripted person.
#pragma once

#include <gmock/gmock.h>

#include <memory>
#include <numbers>
#include <string>
#include <utility>

#include "client/cell/sensors/simulated/simulated_sensor.h"
#include "client/teaching/turntable/guided_teaching.h"
#include "files/messages/pose_message.h"
#include "tests/client/catalogue_server.h"
#include "tests/client/teaching/turntable/turntable_and_person.h"
#include "tests/rendering/small_kinect.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::client {

class GuidedTeachingTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ShowPart("bracket-right");
    options_.cell = CellAround(Axis());
    options_.frames = 2;
  }

  // Puts the part on the turntable.
  void ShowPart(const std::string& id) {
    part_ = graspdb::testing::PartNamed(id);
    auto sensor = SimulatedSensor::Create(graspdb::testing::SmallKinectV2(), WithScenery(part_),
                                          [this] { return table_.Scene(); });
    ASSERT_THAT(sensor, ::graspdb::testing::IsOk());
    sensor_ = *std::move(sensor);
    options_.object_id = part_.object_id;
  }

  static v1::Cell CellAround(const Eigen::Vector2d& middle) {
    v1::Cell cell;
    cell.set_name("cells/press");
    v1::AxisAlignedBox* region = cell.mutable_region_of_interest();
    region->mutable_min()->set_x(middle.x() - 0.2);
    region->mutable_min()->set_y(middle.y() - 0.2);
    region->mutable_min()->set_z(-0.02);
    region->mutable_max()->set_x(middle.x() + 0.2);
    region->mutable_max()->set_y(middle.y() + 0.2);
    region->mutable_max()->set_z(0.3);
    return cell;
  }
  absl::StatusOr<GuidedCounts> Teach(Person& person) {
    return GuidedTeaching(*sensor_, client_, person, options_).Run();
  }
  // A new frame of the turned part, in the frame of the turntable's axis.
  void ExpectRecognisedAt(double azimuth_deg) {
    table_.turned_deg = azimuth_deg;
    auto frame = sensor_->Next(MonotonicTime::InfiniteFuture());
    ASSERT_THAT(frame, ::graspdb::testing::IsOk());
    v1::RecognizeRequest request;
    *request.mutable_depth_image() = std::get<v1::DepthImage>(frame->scan);
    *request.mutable_sensor_pose() = files::ToMessage(*frame->world_sensor);
    *request.mutable_region_of_interest() = options_.cell.region_of_interest();
    const auto response = client_.Recognize(request);
    ASSERT_THAT(response, ::graspdb::testing::IsOk());
    ASSERT_EQ(response->detections_size(), 1);
    EXPECT_EQ(response->detections(0).object(), "objects/" + part_.object_id);
    const recognition::Pose found = files::FromMessage(response->detections(0).refined_pose());
    const recognition::Pose off = found.inverse() * OnTurntable(Axis(), 0, table_.turned_deg);
    EXPECT_LT(off.translation().norm(), 0.003);
    EXPECT_LT(Eigen::AngleAxisd(off.linear()).angle(), 2 * std::numbers::pi / 180);
  }
  std::size_t ViewCount(const std::string& stable_pose = "pose-1") {
    const auto views =
        client_.ListViews("objects/" + part_.object_id + "/stablePoses/" + stable_pose);
    return views.ok() ? views->size() : 0;
  }

  rendering::Workpiece part_;
  Turntable table_;
  GuidedOptions options_;
  graspdb::testing::CatalogueServer server_;
  Client& client_ = server_.client();
  std::unique_ptr<SimulatedSensor> sensor_;
};

}  // namespace graspdb::client
