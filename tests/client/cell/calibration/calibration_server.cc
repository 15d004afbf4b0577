#include "tests/client/cell/calibration/calibration_server.h"

#include <vector>

#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/capture_plan.h"
#include "rendering/simulation.h"
#include "tests/rendering/small_kinect.h"
#include "tests/testing/status_matchers.h"

namespace graspdb::testing {
namespace {

using rendering::PlannedCapture;
using rendering::Workpiece;

std::vector<PlannedCapture> PlanFor(const std::vector<Workpiece>& parts) {
  rendering::TurntableOptions options;
  options.stand.look_down_deg = {20, 40, 60, 80};
  options.stand.distances_m = {0.7};
  auto plan = rendering::PlanTurntable(parts, options);
  EXPECT_THAT(plan, IsOk());
  return plan.ok() ? *plan : std::vector<PlannedCapture>();
}

}  // namespace

void CalibrationServer::Teach(const std::string& part, const rendering::DepthCameraModel& model) {
  const std::vector<Workpiece> parts = {PartNamed(part)};
  const std::string object = "objects/" + part;
  v1::CreateObjectRequest create;
  create.set_object_id(part);
  ASSERT_THAT(client().CreateObject(create), IsOk());
  v1::CreateStablePoseRequest pose;
  pose.set_parent(object);
  pose.set_stable_pose_id(parts.front().stable_pose_id);
  pose.mutable_stable_pose()->set_symmetry_order(parts.front().symmetry_order);
  ASSERT_THAT(client().CreateStablePose(pose), IsOk());
  auto camera = rendering::DepthCamera::Create(model);
  ASSERT_THAT(camera, IsOk());
  const std::vector<PlannedCapture> plan = PlanFor(parts);
  std::size_t next = 0;
  const auto next_view = [&](v1::UploadViewsRequest* request) -> absl::StatusOr<bool> {
    if (next == plan.size()) return false;
    const PlannedCapture& capture = plan[next];
    auto frame = camera->Render(rendering::SceneOf(parts, capture, /*with_table=*/true),
                                capture.world_sensor, capture.seed);
    if (!frame.ok()) return frame.status();
    request->set_parent(object + "/stablePoses/" + parts.front().stable_pose_id);
    request->set_view_id("view-" + std::to_string(next++));
    v1::View* view = request->mutable_view();
    *view->mutable_cloud() =
        files::CloudMessage(rendering::ToPoints(*frame, model.intrinsics), model.intrinsics.width);
    *view->mutable_sensor_pose() = files::ToMessage(capture.world_sensor);
    *view->mutable_object_pose() = files::ToMessage(capture.placements.front().world_object);
    return true;
  };
  const auto taught = client().UploadViews(next_view);
  ASSERT_THAT(taught, IsOk());
  ASSERT_EQ(taught->created_count(), static_cast<int>(plan.size()));
}

void CalibrationServer::MakeCell(const std::string& id, const recognition::Pose* world_sensor) {
  v1::CreateCellRequest request;
  request.set_cell_id(id);
  if (world_sensor != nullptr) {
    *request.mutable_cell()->mutable_sensor_pose() = files::ToMessage(*world_sensor);
  }
  ASSERT_THAT(client().CreateCell(request), IsOk());
}

}  // namespace graspdb::testing
