#include "tests/recognition/scenes/taught_shapes.h"

#include <algorithm>
#include <numbers>

#include "absl/strings/str_format.h"
#include "recognition/segmentation/region.h"

namespace graspdb::testing {
namespace {

using Eigen::Vector3d;
using recognition::Box;
using recognition::OrientedCloud;
using recognition::Points;
using recognition::Pose;

constexpr int kViewSpacingDeg = 20;

std::vector<Box> BoxesOf(const std::string& object) {
  if (object == "bracket") {
    return {{{-0.045, -0.035, 0}, {0.045, 0.035, 0.03}},
            {{-0.045, -0.035, 0.03}, {-0.025, 0.035, 0.06}},
            {{0.015, -0.035, 0.03}, {0.045, -0.01, 0.045}}};
  }
  if (object == "tower") {
    return {{{-0.025, -0.025, 0}, {0.025, 0.025, 0.12}}, {{0.025, -0.02, 0}, {0.06, 0, 0.04}}};
  }
  return {{{-0.06, -0.045, 0}, {0.06, 0.045, 0.03}}, {{-0.06, 0, 0.03}, {-0.02, 0.045, 0.06}}};
}

recognition::TaughtGrasp Grasp(const std::string& id, int priority, const Vector3d& at) {
  recognition::TaughtGrasp grasp;
  grasp.id = id;
  grasp.priority = priority;
  grasp.object_tcp.linear() = Vector3d(1, -1, -1).asDiagonal();  // the tool looks down
  grasp.object_tcp.translation() = at;
  return grasp;
}

}  // namespace

TaughtShapes::TaughtShapes(bool shares_frame)
    : shares_frame_(shares_frame),
      snapshot_{
          7, recognition::DescriptorIndex(DescriptorSize(recognition::DescriptorParameters{}.kind)),
          nullptr} {
  Teach("bracket", {Grasp("side", 1, {-0.04, 0, 0.05}), Grasp("top", 5, {0, 0, 0.10})});
  Teach("tower", {Grasp("top", 0, {0, 0, 0.13})});
  Teach("slab", {});
  snapshot_.index = snapshot_.index.With(views_);
  snapshot_.stable_poses = std::make_shared<const decltype(stable_poses_)>(stable_poses_);
}

Solid TaughtShapes::Part(const std::string& object, double x, double y, double yaw_deg) {
  Solid out;
  out.world_solid.linear() =
      Eigen::AngleAxisd(yaw_deg * std::numbers::pi / 180, Vector3d::UnitZ()).toRotationMatrix();
  out.world_solid.translation() = Vector3d(x, y, 0);
  out.boxes = BoxesOf(object);
  return out;
}

Pose TaughtShapes::WorldSensor() { return LookAt({0, -0.45, 0.45}, {0, 0, 0.03}); }

recognition::Scan TaughtShapes::See(const std::vector<Solid>& parts) {
  recognition::Scan scan;
  scan.points = TakePicture({parts}, WorldSensor(), SmallCamera()).points;
  scan.world_sensor = WorldSensor();
  return scan;
}

recognition::Scan TaughtShapes::SeeFinely(const std::vector<Solid>& parts) {
  recognition::CameraIntrinsics camera = SmallCamera();
  camera.width *= 2;
  camera.height *= 2;
  for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value *= 2;
  recognition::Scan scan;
  scan.points = TakePicture({parts}, WorldSensor(), camera).points;
  scan.width = camera.width;
  scan.world_sensor = WorldSensor();
  return scan;
}

void TaughtShapes::Teach(const std::string& object, std::vector<recognition::TaughtGrasp> grasps) {
  const std::string object_name = "objects/" + object;
  const std::string pose_name = object_name + "/stablePoses/upright";
  recognition::TaughtStablePose taught{pose_name, 1, std::move(grasps)};
  const Vector3d eye = WorldSensor().translation();
  for (int yaw = 0; yaw < 360; yaw += kViewSpacingDeg) {
    const Solid part = Part(object, 0, 0, yaw);
    const Points seen = TakePicture({{part}, 0}, WorldSensor(), SmallCamera()).points;
    const Points points = recognition::CropToRegion(seen, WorldSensor(), std::nullopt).points;
    auto cloud = std::make_shared<OrientedCloud>(recognition::PrepareCloud(points, eye, {}));
    auto view = std::make_shared<recognition::TaughtView>();
    view->name = absl::StrFormat("%s/views/%03d", pose_name, yaw);
    view->object = object_name;
    view->stable_pose = pose_name;
    view->world_object = part.world_solid;
    view->world_sensor = WorldSensor();
    auto descriptor = Describe(*cloud, eye, recognition::DescriptorParameters{}.kind);
    Add(view->name, std::move(cloud));
    view->shares_frame = shares_frame_;
    taught.views.push_back(view);
    views_.push_back({std::move(view), *std::move(descriptor)});
  }
  stable_poses_[pose_name] =
      std::make_shared<const recognition::TaughtStablePose>(std::move(taught));
}

double LargestCornerError(const std::string& object, const Pose& a, const Pose& b) {
  double largest = 0;
  for (const Box& box : BoxesOf(object)) {
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d p((corner & 1) != 0 ? box.min.x() : box.max.x(),
                       (corner & 2) != 0 ? box.min.y() : box.max.y(),
                       (corner & 4) != 0 ? box.min.z() : box.max.z());
      largest = std::max(largest, (a * p - b * p).norm());
    }
  }
  return largest;
}

}  // namespace graspdb::testing
