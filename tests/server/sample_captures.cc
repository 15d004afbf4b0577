#include "tests/server/sample_captures.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "recognition/points/depth_image.h"
#include "recognition/segmentation/segmentation.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/sample_parts.h"

namespace graspdb::testing {
namespace {

constexpr double kCount = 0.0001;  // m

// A Kinect v2 with a quarter of the pixels: points 3 mm apart at 0.6 m.
rendering::DepthCameraModel SmallKinect() {
  rendering::DepthCameraModel model = rendering::KinectV2();
  model.intrinsics = {
      .width = 256, .height = 212, .fx = 182.75, .fy = 182.75, .cx = 127.5, .cy = 105.5};
  return model;
}

const rendering::DepthCamera& Camera() {
  static const auto camera = rendering::DepthCamera::Create(SmallKinect());
  return *camera;
}

rendering::Scene SceneOf(const std::string& part, const recognition::Pose& world_object) {
  rendering::Scene scene;
  scene.objects.push_back({&Part(part).mesh, world_object});
  return scene;
}

recognition::Pose PoseOf(const Stand& stand) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.translation() = Eigen::Vector3d(stand.x, stand.y, 0);
  pose.rotate(Eigen::AngleAxisd(stand.turn_deg * std::numbers::pi / 180, Eigen::Vector3d::UnitZ()));
  return pose;
}

recognition::Pose SensorPose() { return rendering::LookAt(Eigen::Vector3d::Zero(), 0.65, 45, -90); }

Frame FrameOf(const rendering::DepthFrame& image, const recognition::Pose& world_object) {
  Frame frame;
  frame.camera = Camera().model().intrinsics;
  for (const float depth : image.depth_m) {
    frame.counts.push_back(
        static_cast<std::uint16_t>(std::lround(static_cast<double>(depth) / kCount)));
  }
  frame.world_sensor = SensorPose();
  frame.world_object = world_object;
  return frame;
}

rendering::DepthFrame Render(const rendering::Scene& scene, std::uint64_t seed) {
  absl::StatusOr<rendering::DepthFrame> image = Camera().Render(scene, SensorPose(), seed);
  if (!image.ok()) std::abort();
  return *std::move(image);
}

}  // namespace

const rendering::Workpiece& Part(const std::string& id) {
  static const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  for (const rendering::Workpiece& part : parts) {
    if (part.object_id == id) return part;
  }
  std::abort();
}

Frame Photograph(const std::string& part, const Stand& stand, std::uint64_t seed) {
  return FrameOf(Render(SceneOf(part, PoseOf(stand)), seed), PoseOf(stand));
}

Frame PhotographEmptyTable() {
  return FrameOf(Render(rendering::Scene(), 1), recognition::Pose::Identity());
}

v1::DepthImage DepthImageOf(const Frame& frame) {
  v1::DepthImage out;
  out.mutable_intrinsics()->set_width(frame.camera.width);
  out.mutable_intrinsics()->set_height(frame.camera.height);
  out.mutable_intrinsics()->set_fx(frame.camera.fx);
  out.mutable_intrinsics()->set_fy(frame.camera.fy);
  out.mutable_intrinsics()->set_cx(frame.camera.cx);
  out.mutable_intrinsics()->set_cy(frame.camera.cy);
  out.set_depth_unit_m(kCount);
  out.mutable_data()->assign(reinterpret_cast<const char*>(frame.counts.data()),
                             2 * frame.counts.size());
  return out;
}

v1::PointCloud CloudOf(const Frame& frame) {
  return files::CloudMessage(recognition::PointsOf({frame.counts, frame.camera, kCount}),
                             frame.camera.width);
}

v1::PointCloud SegmentedCloudOf(const std::string& part, const Stand& stand, std::uint64_t seed) {
  const rendering::DepthFrame image = Render(SceneOf(part, PoseOf(stand)), seed);
  const recognition::Points all = rendering::ToPoints(image, Camera().model().intrinsics);
  recognition::Points points;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (image.surface[i] == 0) points.push_back(all[i]);
  }
  return PackedCloud(points);
}

v1::PointCloud PackedCloud(const recognition::Points& points) {
  return files::CloudMessage(points, 0);
}

v1::Pose PoseMessage(const recognition::Pose& pose) { return files::ToMessage(pose); }

v1::AxisAlignedBox BoxMessage(const Eigen::Vector3d& min, const Eigen::Vector3d& max) {
  v1::AxisAlignedBox out;
  out.mutable_min()->set_x(min.x());
  out.mutable_min()->set_y(min.y());
  out.mutable_min()->set_z(min.z());
  out.mutable_max()->set_x(max.x());
  out.mutable_max()->set_y(max.y());
  out.mutable_max()->set_z(max.z());
  return out;
}

double ShiftBetween(const recognition::Pose& a, const v1::Pose& b) {
  return (a.translation() - files::FromMessage(b).translation()).norm();
}

}  // namespace graspdb::testing
