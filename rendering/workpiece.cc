#include "rendering/workpiece.h"

#include <numbers>

#include "files/messages/pose_message.h"

namespace graspdb::rendering {
namespace {

constexpr double kApproachDistanceM = 0.10;

}  // namespace

v1::Grasp TopGrasp(const std::string& grasp_id, const Eigen::Vector3d& position, double closing_rad,
                   double gripper_opening_m) {
  recognition::Pose pose = recognition::Pose::Identity();
  pose.translation() = position;
  pose.rotate(Eigen::AngleAxisd(closing_rad, Eigen::Vector3d::UnitZ()));
  pose.rotate(Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX()));
  v1::Grasp grasp;
  grasp.set_grasp_id(grasp_id);
  *grasp.mutable_tcp_pose() = files::ToMessage(pose);
  grasp.set_approach_distance_m(kApproachDistanceM);
  grasp.set_gripper_opening_m(gripper_opening_m);
  return grasp;
}

v1::CapturedObject DeclarationOf(const Workpiece& workpiece) {
  v1::CapturedObject object;
  object.set_object_id(workpiece.object_id);
  object.set_display_name(workpiece.display_name);
  object.set_mesh_path("models/" + workpiece.object_id + ".ply");
  v1::CapturedStablePose* pose = object.add_stable_poses();
  pose->set_stable_pose_id(workpiece.stable_pose_id);
  pose->set_symmetry_order(workpiece.symmetry_order);
  if (workpiece.object_mesh) *pose->mutable_mesh_pose() = files::ToMessage(*workpiece.object_mesh);
  for (const v1::Grasp& grasp : workpiece.grasps) *pose->add_grasps() = grasp;
  return object;
}

}  // namespace graspdb::rendering
