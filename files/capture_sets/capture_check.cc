#include "files/capture_sets/capture_check.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/messages/pose_message.h"

namespace graspdb::files {
namespace {

// Longer than any length of a grasp that is in metres; the server rejects distances beyond it.
constexpr double kMaxGraspLengthM = 10;

// The farthest point that the server accepts from a sensor, max_range_m of the contract.
constexpr double kMaxSensorDistanceM = 100;

// The stable poses of every object.
using Declared = std::map<std::string, std::set<std::string>>;

absl::Status CheckNewId(const std::string& id, bool is_new, const std::string& field) {
  if (id.empty()) return absl::InvalidArgumentError(field + " is missing; give it an id");
  if (!is_new)
    return absl::InvalidArgumentError(
        absl::StrCat(field, " \"", id, "\" is used twice; give it another id"));
  return absl::OkStatus();
}

absl::Status CheckPath(const std::string& text, const std::string& field) {
  const std::filesystem::path path = std::filesystem::path(text).lexically_normal();
  if (text.empty())
    return absl::InvalidArgumentError(field + " is missing; name a file in the folder");
  if (path.is_absolute() || (path.begin() != path.end() && *path.begin() == "..")) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, " \"", text, "\" leads out of the folder of the capture set; ",
                     "give a path within it"));
  }
  return absl::OkStatus();
}

absl::Status CheckGrasp(const v1::Grasp& grasp, bool is_new, const std::string& field) {
  RETURN_IF_ERROR(CheckNewId(grasp.grasp_id(), is_new, field + ".graspId"));
  RETURN_IF_ERROR(CheckPose(grasp.tcp_pose(), field + ".tcpPose"));
  for (const double length :
       {grasp.approach_distance_m(), grasp.gripper_opening_m(), grasp.retreat_distance_m()}) {
    if (!std::isfinite(length) || length < 0) {
      return absl::InvalidArgumentError(
          field + " has a length that is negative or not finite; give metres");
    }
  }
  const double longest = LongestLengthOf(grasp);
  if (longest > kMaxGraspLengthM) {
    return absl::InvalidArgumentError(absl::StrCat(
        field, " has a length of ", longest, " m; lengths are in metres, are these millimetres?"));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status CheckStablePose(const v1::CapturedStablePose& pose, const std::string& field) {
  if (pose.symmetry_order() < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, ".symmetryOrder is ", pose.symmetry_order(),
                     "; give 1 for none, n for n-fold, 0 for any turn"));
  }
  if (!(pose.min_score() >= 0 && pose.min_score() <= 1)) {
    return absl::InvalidArgumentError(
        absl::StrCat(field, ".minScore is ", pose.min_score(), "; give 0 to 1"));
  }
  if (pose.has_mesh_pose()) {
    RETURN_IF_ERROR(CheckPose(pose.mesh_pose(), field + ".meshPose"));
  }
  std::set<std::string> grasps;
  for (int i = 0; i < pose.grasps_size(); ++i) {
    const bool is_new = grasps.insert(pose.grasps(i).grasp_id()).second;
    RETURN_IF_ERROR(CheckGrasp(pose.grasps(i), is_new, absl::StrCat(field, ".grasps[", i, "]")));
  }
  return absl::OkStatus();
}

namespace {

absl::Status CheckObject(const v1::CapturedObject& object, const std::string& field,
                         Declared& declared) {
  const auto [entry, is_new] = declared.try_emplace(object.object_id());
  RETURN_IF_ERROR(CheckNewId(object.object_id(), is_new, field + ".objectId"));
  if (!object.mesh_path().empty()) {
    RETURN_IF_ERROR(CheckPath(object.mesh_path(), field + ".meshPath"));
  }
  for (int i = 0; i < object.stable_poses_size(); ++i) {
    const v1::CapturedStablePose& pose = object.stable_poses(i);
    const std::string name = absl::StrCat(field, ".stablePoses[", i, "]");
    const bool is_new_pose = entry->second.insert(pose.stable_pose_id()).second;
    RETURN_IF_ERROR(CheckNewId(pose.stable_pose_id(), is_new_pose, name + ".stablePoseId"));
    RETURN_IF_ERROR(CheckStablePose(pose, name));
  }
  return absl::OkStatus();
}

absl::Status CheckRegion(const v1::AxisAlignedBox& box) {
  const bool good = std::isfinite(box.min().x()) && std::isfinite(box.min().y()) &&
                    std::isfinite(box.min().z()) && std::isfinite(box.max().x()) &&
                    std::isfinite(box.max().y()) && std::isfinite(box.max().z()) &&
                    box.min().x() <= box.max().x() && box.min().y() <= box.max().y() &&
                    box.min().z() <= box.max().z();
  if (good) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "regionOfInterest has a corner min above max; give metres in the world frame");
}

absl::Status CheckNames(const v1::Capture& capture, const std::string& field,
                        const Declared& declared) {
  const bool named = !capture.object_id().empty() && !capture.stable_pose_id().empty();
  if (capture.split() == v1::Capture::TEACH && !named) {
    return absl::InvalidArgumentError(
        field + " has the split TEACH; give it an objectId and a stablePoseId");
  }
  if (capture.object_id().empty()) return absl::OkStatus();
  const auto object = declared.find(capture.object_id());
  if (object == declared.end()) {
    return absl::InvalidArgumentError(absl::StrCat(field, ".objectId \"", capture.object_id(),
                                                   "\" is not in objects; declare it there"));
  }
  if (!capture.stable_pose_id().empty() && !object->second.contains(capture.stable_pose_id())) {
    return absl::InvalidArgumentError(absl::StrCat(
        field, ".stablePoseId \"", capture.stable_pose_id(), "\" is not among the stable poses of ",
        capture.object_id(), "; declare it there"));
  }
  return absl::OkStatus();
}

absl::Status CheckCapture(const v1::Capture& capture, const std::string& field,
                          const Declared& declared) {
  RETURN_IF_ERROR(CheckPath(capture.path(), field + ".path"));
  RETURN_IF_ERROR(CheckNames(capture, field, declared));
  if (capture.has_object_pose()) {
    RETURN_IF_ERROR(CheckPose(capture.object_pose(), field + ".objectPose"));
  }
  if (!capture.has_sensor_pose()) return absl::OkStatus();
  return CheckPose(capture.sensor_pose(), field + ".sensorPose");
}

}  // namespace

double LongestLengthOf(const v1::Grasp& grasp) {
  const v1::Vector3& tcp = grasp.tcp_pose().position();
  return std::max({std::hypot(tcp.x(), tcp.y(), tcp.z()), grasp.approach_distance_m(),
                   grasp.gripper_opening_m(), grasp.retreat_distance_m()});
}

absl::Status CheckId(const std::string& id, const std::string& field) {
  const auto is_part = [](char c) {
    return absl::ascii_isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '.' || c == '-';
  };
  if (!id.empty() && id.size() <= kMaxIdLength && std::ranges::all_of(id, is_part) &&
      absl::ascii_isalnum(static_cast<unsigned char>(id.front()))) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat(
      field, " \"", absl::Utf8SafeCEscape(id), "\" is not an id; give 1 to ", kMaxIdLength,
      " characters of [A-Za-z0-9_.-] that begin with a letter or a digit"));
}

absl::Status CheckCaptureSet(const v1::CaptureSet& set) {
  Declared declared;
  for (int i = 0; i < set.objects_size(); ++i) {
    RETURN_IF_ERROR(CheckObject(set.objects(i), absl::StrCat("objects[", i, "]"), declared));
  }
  if (set.has_region_of_interest()) {
    RETURN_IF_ERROR(CheckRegion(set.region_of_interest()));
  }
  for (int i = 0; i < set.captures_size(); ++i) {
    RETURN_IF_ERROR(CheckCapture(set.captures(i), absl::StrCat("captures[", i, "]"), declared));
  }
  return absl::OkStatus();
}

absl::Status CheckDistances(const v1::CaptureSet& set) {
  for (int i = 0; i < set.captures_size(); ++i) {
    const v1::Capture& capture = set.captures(i);
    if (!capture.has_object_pose() || !capture.has_sensor_pose()) continue;
    const v1::Vector3& object = capture.object_pose().position();
    const v1::Vector3& sensor = capture.sensor_pose().position();
    const double distance =
        std::hypot(object.x() - sensor.x(), object.y() - sensor.y(), object.z() - sensor.z());
    if (distance <= kMaxSensorDistanceM) continue;
    return absl::InvalidArgumentError(
        absl::StrCat("captures[", i, "].objectPose is ", distance,
                     " m from sensorPose; positions are in metres, are these millimetres?"));
  }
  return absl::OkStatus();
}

}  // namespace graspdb::files
