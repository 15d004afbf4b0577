#include "server/requests/convert.h"

#include <cmath>
#include <set>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/pose_message.h"
#include "files/messages/read_scan.h"
#include "recognition/base/units.h"
#include "server/base/errors.h"
#include "server/requests/request_limits.h"
#include "storage/records/resource_name.h"

namespace graspdb::server {
namespace {

using recognition::kDegreesPerRadian;
using recognition::kRadiansPerDegree;

constexpr double kMaxPosition = 1000;  // m
constexpr double kNormTolerance = 1e-3;
// Of a quaternion that was normalised in double precision.
constexpr double kNormRounding = 1e-14;

// Copies a field that is set, if it is in [lo, hi].
template <typename T, typename U>
absl::Status Apply(bool given, T value, T lo, T hi, std::string_view path, std::string_view field,
                   U* target) {
  if (!given) return absl::OkStatus();
  if (!(value >= lo && value <= hi)) {
    return InvalidField(FieldPath(path, field),
                        absl::StrCat("is ", value, "; it must lie in ", lo, " to ", hi));
  }
  *target = value;
  return absl::OkStatus();
}

absl::Status CheckLength(double length_m, std::string_view path, std::string_view field) {
  if (length_m >= 0 && length_m <= 10) return absl::OkStatus();
  return InvalidField(FieldPath(path, field), "must lie in 0 to 10 m");
}

absl::StatusOr<recognition::TaughtGrasp> GraspFromProto(const v1::Grasp& grasp,
                                                        std::string_view path) {
  absl::Status status =
      AtField(FieldPath(path, "grasp_id"), storage::ValidateResourceId(grasp.grasp_id()));
  status.Update(CheckLength(grasp.approach_distance_m(), path, "approach_distance_m"));
  status.Update(CheckLength(grasp.gripper_opening_m(), path, "gripper_opening_m"));
  status.Update(CheckLength(grasp.retreat_distance_m(), path, "retreat_distance_m"));
  if (!status.ok()) return status;
  ASSIGN_OR_RETURN(recognition::Pose tcp,
                   PoseFromProto(grasp.tcp_pose(), FieldPath(path, "tcp_pose")));
  recognition::TaughtGrasp out;
  out.id = grasp.grasp_id();
  out.object_tcp = tcp;
  out.approach_distance_m = grasp.approach_distance_m();
  out.gripper_opening_m = grasp.gripper_opening_m();
  out.retreat_distance_m = grasp.retreat_distance_m();
  out.priority = grasp.priority();
  const v1::Grasp::FreeTurn& turn = grasp.free_turn();
  if (!(turn.min_deg() >= -360 && turn.min_deg() <= turn.max_deg() && turn.max_deg() <= 360)) {
    return InvalidField(FieldPath(path, "free_turn"),
                        "must have min_deg up to max_deg, both in -360 to 360 degrees");
  }
  if (grasp.has_free_turn()) {
    out.free_turn = {turn.min_deg() * kRadiansPerDegree, turn.max_deg() * kRadiansPerDegree};
  }
  return out;
}

// To a billionth of a degree, so that 30 degrees are 30 again.
double DegreesOf(double rad) { return std::round(rad * kDegreesPerRadian * 1e9) / 1e9; }

}  // namespace

absl::StatusOr<recognition::Pose> PoseFromProto(const v1::Pose& pose, std::string_view path) {
  const Eigen::Vector3d position = files::FromMessage(pose.position());
  if (!position.allFinite() || position.norm() > kMaxPosition) {
    return InvalidField(FieldPath(path, "position"),
                        "must be finite and within 1000 m of the origin");
  }
  const v1::Quaternion& q = pose.orientation();
  const Eigen::Quaterniond rotation(q.w(), q.x(), q.y(), q.z());
  const double norm = rotation.norm();
  if (!(std::abs(norm - 1) <= kNormTolerance)) {
    return InvalidField(FieldPath(path, "orientation"),
                        absl::StrCat("has norm ", norm, "; a rotation is a unit quaternion"));
  }
  return files::FromMessage(pose);
}

v1::Pose PoseToProto(const recognition::Pose& pose) {
  v1::Pose out;
  *out.mutable_position() = files::ToMessage(pose.translation());
  Eigen::Quaterniond q(pose.linear());
  if (q.w() < 0) q.coeffs() = -q.coeffs();  // unique representation
  *out.mutable_orientation() = files::ToMessage(q);
  return out;
}

v1::Grasp GraspToProto(const recognition::TaughtGrasp& grasp) {
  v1::Grasp out;
  out.set_grasp_id(grasp.id);
  *out.mutable_tcp_pose() = PoseToProto(grasp.object_tcp);
  out.set_approach_distance_m(grasp.approach_distance_m);
  out.set_gripper_opening_m(grasp.gripper_opening_m);
  out.set_retreat_distance_m(grasp.retreat_distance_m);
  out.set_priority(grasp.priority);
  if (grasp.free_turn) {
    out.mutable_free_turn()->set_min_deg(DegreesOf(grasp.free_turn->min_rad));
    out.mutable_free_turn()->set_max_deg(DegreesOf(grasp.free_turn->max_rad));
  }
  return out;
}

v1::Pose StoredPose(const v1::Pose& given, const recognition::Pose& parsed) {
  const v1::Quaternion& q = given.orientation();
  const double norm = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).norm();
  if (q.w() < 0 || std::abs(norm - 1) > kNormRounding) return PoseToProto(parsed);
  v1::Pose out = given;
  out.mutable_position();  // absent is the origin
  out.DiscardUnknownFields();
  return out;
}

absl::StatusOr<recognition::Box> BoxFromProto(const v1::AxisAlignedBox& box,
                                              std::string_view path) {
  const recognition::Box out = files::FromMessage(box);
  if (!out.min.allFinite() || !out.max.allFinite()) {
    return InvalidField(path, "must have finite corners");
  }
  if ((out.min.array() >= out.max.array()).any()) {
    return InvalidField(path, "is empty: min must be smaller than max in x, y and z");
  }
  return out;
}

absl::Status ApplyPipeline(const v1::PipelineParameters& p, std::string_view path,
                           recognition::RecognitionParameters* parameters) {
  auto& s = parameters->segmentation;
  auto& m = parameters->matching;
  absl::Status status;
  status.Update(Apply(p.has_plane_distance_m(), p.plane_distance_m(), 0.0005, 0.1, path,
                      "plane_distance_m", &s.plane_distance_m));
  status.Update(Apply(p.has_outlier_neighbor_count(), p.outlier_neighbor_count(), 0, 200, path,
                      "outlier_neighbor_count", &s.outlier_neighbor_count));
  status.Update(Apply(p.has_outlier_deviation_factor(), p.outlier_deviation_factor(), 0.1, 100.0,
                      path, "outlier_deviation_factor", &s.outlier_deviation_factor));
  status.Update(Apply(p.has_cluster_tolerance_m(), p.cluster_tolerance_m(), 0.003, 0.2, path,
                      "cluster_tolerance_m", &s.cluster_tolerance_m));
  status.Update(Apply(p.has_min_cluster_point_count(), p.min_cluster_point_count(), 10, 100000,
                      path, "min_cluster_point_count", &s.min_cluster_point_count));
  status.Update(Apply(p.has_verified_view_count(), p.verified_view_count(), 1, 100, path,
                      "verified_view_count", &m.verified_view_count));
  status.Update(Apply(p.has_icp_iteration_count(), p.icp_iteration_count(), 0, 1000, path,
                      "icp_iteration_count", &m.icp_iteration_count));
  status.Update(Apply(p.has_min_score(), p.min_score(), 0.0, 1.0, path, "min_score", &m.min_score));
  status.Update(
      Apply(p.has_max_range_m(), p.max_range_m(), 0.1, 100.0, path, "max_range_m", &s.max_range_m));
  status.Update(Apply(p.has_max_object_size_m(), p.max_object_size_m(), 0.01, 5.0, path,
                      "max_object_size_m", &s.max_object_size_m));
  status.Update(Apply(p.has_further_view_count(), p.further_view_count(), 0, 10'000, path,
                      "further_view_count", &m.further_view_count));
  status.Update(Apply(p.has_further_view_budget(), p.further_view_budget(), 0, 100'000, path,
                      "further_view_budget", &m.further_view_budget));
  return status;
}

absl::StatusOr<recognition::TaughtStablePose> StablePoseFromProto(const v1::StablePose& pose) {
  recognition::TaughtStablePose out;
  out.name = pose.name();
  out.symmetry_order = pose.has_symmetry_order() ? pose.symmetry_order() : 1;
  if (out.symmetry_order < 0 || out.symmetry_order > 360) {
    return InvalidField("stable_pose.symmetry_order",
                        "must lie in 0 (any turn) to 360, 1 for no symmetry");
  }
  if (pose.has_min_score()) {
    if (!(pose.min_score() >= 0 && pose.min_score() <= 1)) {
      return InvalidField("stable_pose.min_score", "must lie in 0 to 1");
    }
    out.min_score = pose.min_score();
  }
  if (pose.has_mesh_pose()) {
    ASSIGN_OR_RETURN(out.object_mesh, PoseFromProto(pose.mesh_pose(), "stable_pose.mesh_pose"));
  }
  if (pose.grasps_size() > kMaxGrasps) {
    return InvalidField("stable_pose.grasps",
                        absl::StrCat("has more than ", kMaxGrasps, " grasps"));
  }
  std::set<std::string> ids;
  for (int i = 0; i < pose.grasps_size(); ++i) {
    const std::string path = absl::StrCat("stable_pose.grasps[", i, "]");
    ASSIGN_OR_RETURN(recognition::TaughtGrasp grasp, GraspFromProto(pose.grasps(i), path));
    if (!ids.insert(grasp.id).second) {
      return InvalidField(FieldPath(path, "grasp_id"), "must be unique within the stable pose");
    }
    out.grasps.push_back(std::move(grasp));
  }
  return out;
}

absl::Status ReadScan(const v1::RecognizeRequest& request, std::size_t max_points,
                      recognition::Scan* scan) {
  const files::ScanRules rules{.wrong = &InvalidField, .max_points = max_points};
  switch (request.scan_case()) {
    case v1::RecognizeRequest::kCloud:
      return files::ReadScan(request.cloud(), rules, "cloud", scan);
    case v1::RecognizeRequest::kDepthImage:
      return files::ReadScan(request.depth_image(), rules, "depth_image", scan);
    case v1::RecognizeRequest::SCAN_NOT_SET:
      break;
  }
  return InvalidField("scan", "is missing: give a cloud or a depth_image");
}

absl::Status ReadScan(const v1::View& view, std::size_t max_points, recognition::Scan* scan) {
  if (view.has_cloud() && view.has_depth_image()) {
    return InvalidField("view", "has both a cloud and a depth_image; give one of them");
  }
  const files::ScanRules rules{.wrong = &InvalidField, .max_points = max_points};
  if (view.has_cloud()) return files::ReadScan(view.cloud(), rules, "view.cloud", scan);
  if (view.has_depth_image()) {
    return files::ReadScan(view.depth_image(), rules, "view.depth_image", scan);
  }
  return InvalidField("view", "has neither a cloud nor a depth_image; give one of them");
}

}  // namespace graspdb::server
