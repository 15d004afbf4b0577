#include "client/cli/recognize/scoreboard.h"

#include <cstdio>
#include <filesystem>
#include <string>

#include "absl/strings/str_format.h"
#include "files/messages/pose_message.h"
#include "recognition/base/units.h"

namespace graspdb::client {
namespace {

int SymmetryOf(const ScanTask& task) {
  for (const v1::CapturedObject& object : task.set->objects()) {
    if (object.object_id() != task.capture.object_id()) continue;
    for (const v1::CapturedStablePose& pose : object.stable_poses()) {
      if (pose.stable_pose_id() != task.capture.stable_pose_id()) continue;
      return pose.has_symmetry_order() ? pose.symmetry_order() : 1;
    }
  }
  return 1;
}

// "bracket-left" of "objects/bracket-left/stablePoses/flat".
std::string ShortName(const std::string& name) {
  const std::string id = name.substr(name.find('/') + 1);
  return id.substr(0, id.find('/'));
}

std::string PoseColumns(const std::optional<Verdict>& verdict) {
  if (!verdict || !verdict->translation_error_m)
    return absl::StrFormat("%8s %7s %8s", "-", "-", "-");
  const std::string add_s =
      verdict->add_s_m ? absl::StrFormat("%8.2f", *verdict->add_s_m * 1000) : "       -";
  return absl::StrFormat("%8.2f %7.2f %s", *verdict->translation_error_m * 1000,
                         *verdict->rotation_error_deg, add_s);
}

// A pose in the world frame, in the format of pose options.
void PrintPose(const std::string& what, const v1::Pose& pose) {
  const v1::Vector3& p = pose.position();
  const v1::Quaternion& q = pose.orientation();
  std::printf("  %s at %.4f,%.4f,%.4f m, orientation %.4f,%.4f,%.4f,%.4f\n", what.c_str(), p.x(),
              p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

void PrintPoses(const v1::RecognizeResponse& response) {
  for (const v1::Detection& detection : response.detections()) {
    if (detection.object().empty() || !detection.has_refined_pose()) continue;
    PrintPose(ShortName(detection.object()), detection.refined_pose());
  }
}

}  // namespace

const v1::Detection* MainDetection(const ScanTask& task, const v1::RecognizeResponse& response) {
  if (response.detections().empty()) return nullptr;
  if (!task.capture.has_object_pose()) return &response.detections(0);
  const v1::Vector3& truth = task.capture.object_pose().position();
  const v1::Detection* best = nullptr;
  double nearest = 0;
  for (const v1::Detection& d : response.detections()) {
    const double dx = d.centroid().x() - truth.x();
    const double dy = d.centroid().y() - truth.y();
    if (best != nullptr && dx * dx + dy * dy >= nearest) continue;
    best = &d;
    nearest = dx * dx + dy * dy;
  }
  return best;
}

std::optional<Verdict> Judge(const ScanTask& task, const v1::RecognizeResponse& response) {
  if (!task.in_set) return std::nullopt;
  Verdict out;
  const v1::Detection* detection = MainDetection(task, response);
  const std::string found = detection == nullptr ? "" : detection->object();
  if (task.capture.object_id().empty()) {
    out.object_right = found.empty();
    return out;
  }
  out.object_right = found == "objects/" + task.capture.object_id();
  if (!out.object_right || !task.capture.has_object_pose()) return out;
  const recognition::Pose truth = files::FromMessage(task.capture.object_pose());
  const recognition::Pose pose = files::FromMessage(detection->refined_pose());
  out.translation_error_m = (truth.translation() - pose.translation()).norm();
  out.rotation_error_deg =
      rendering::RotationError(truth, pose, SymmetryOf(task)) * recognition::kDegreesPerRadian;
  if (task.shape) {
    out.add_s_m = rendering::AddS(*task.shape, truth, pose);
    out.pose_right = rendering::IsRight(*task.shape, *out.add_s_m);
  }
  return out;
}

void Scoreboard::PrintHeader() {
  std::printf("%-28s %-14s %-18s %5s %8s %7s %8s %7s %7s %7s %7s\n", "scan", "status", "object",
              "score", "shift", "turn", "ADD-S", "segment", "match", "refine", "total");
  std::printf("%-28s %-14s %-18s %5s %8s %7s %8s %7s %7s %7s %7s\n", "", "", "", "0-1", "mm", "deg",
              "mm", "ms", "ms", "ms", "ms");
}

void Scoreboard::Add(const ScanTask& task, const v1::RecognizeResponse& response) {
  const std::optional<Verdict> verdict = Judge(task, response);
  const v1::Detection* d = MainDetection(task, response);
  const v1::RecognitionStatus status = d == nullptr ? response.status() : d->status();
  std::string object = d == nullptr || d->object().empty() ? "-" : ShortName(d->object());
  if (verdict && !verdict->object_right) object += " (wrong)";
  const v1::Timings& t = response.timings();
  std::printf("%-28s %-14s %-18s %5.2f %s %7.1f %7.1f %7.1f %7.1f\n",
              std::filesystem::path(task.path).stem().c_str(),
              v1::RecognitionStatus_Name(status).c_str(), object.c_str(),
              d == nullptr ? 0 : d->score(), PoseColumns(verdict).c_str(),
              t.segment_ms() + t.describe_ms(), t.match_ms(), t.register_ms(), t.total_ms());
  if (!verdict) PrintPoses(response);
  if (d != nullptr && d->has_mesh_pose()) PrintPose("mesh frame", d->mesh_pose());
  ++answers_;
  total_ms_ += t.total_ms();
  if (!verdict) return;
  ++judged_;
  objects_right_ += verdict->object_right ? 1 : 0;
  poses_measured_ += verdict->add_s_m ? 1 : 0;
  poses_right_ += verdict->pose_right ? 1 : 0;
}

void Scoreboard::PrintSummary() const {
  if (answers_ == 0) return;
  std::printf("\n%d scans, %.1f ms each on the server", answers_, total_ms_ / answers_);
  if (judged_ > 0) {
    std::printf("; object right %.1f %% (%d of %d)", 100.0 * objects_right_ / judged_,
                objects_right_, judged_);
  }
  if (poses_measured_ > 0) {
    std::printf(
        "; of those the refined pose within 5 %% of the diameter (ADD-S) %.1f %% (%d of %d)",
        100.0 * poses_right_ / poses_measured_, poses_right_, poses_measured_);
  }
  std::printf("\n");
}

}  // namespace graspdb::client
