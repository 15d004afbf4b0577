#include "client/cell/agent/jobs/job_answer.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <iterator>
#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "files/messages/pose_message.h"

namespace graspdb::client {
namespace {

using recognition::Pose;

// Reasons in the text for a frame without a pose.
constexpr std::size_t kMaxReasons = 3;

// An object that matches the job, with its reachable grasps.
struct Object {
  const v1::Detection* detection = nullptr;
  std::vector<const v1::GraspProposal*> grasps;
};

// What makes the detection unfit for the job; empty if it fits.
std::string ObjectionTo(const JobConfig& job, const v1::Detection& detection,
                        const HasLabel& has_label) {
  const std::string& object = detection.object();
  const bool without_grasp =
      detection.status() == v1::NO_GRASP && job.primary == JobPrimary::kObject;
  if (detection.status() != v1::OK && !without_grasp) {
    return absl::StrCat(object, object.empty() ? "" : " ",
                        v1::RecognitionStatus_Name(detection.status()));
  }
  if (detection.score() < job.min_score) {
    return absl::StrFormat("%s scores %.2f, less than min-score", object, detection.score());
  }
  if (!job.object.empty() && object != job.object) return object + " is another object";
  if (job.label.empty() || has_label(object, job.label)) return "";
  return absl::StrCat(object, " lacks the label ", job.label);
}

// Whether a robot at `world_base` (T_world_base) reaches the approach along the tool's z axis, the
// grasp, and the retreat straight up.
bool IsWithinReach(const Reach& reach, const Pose& world_base, const v1::GraspProposal& proposal) {
  const Pose world_tcp = files::FromMessage(proposal.tcp_pose());
  const v1::Grasp& grasp = proposal.grasp();
  const Eigen::Vector3d at = world_tcp.translation();
  const Eigen::Vector3d before =
      at - grasp.approach_distance_m() * world_tcp.linear().col(2).eval();
  const Eigen::Vector3d above = at + grasp.retreat_distance_m() * Eigen::Vector3d::UnitZ();
  for (const Eigen::Vector3d& point : std::array{at, before, above}) {
    const double distance = (point - world_base.translation()).norm();
    if (distance < reach.min_m || distance > reach.max_m) return false;
    if (reach.workspace && !reach.workspace->Contains(point)) return false;
  }
  return true;
}

std::vector<Object> ObjectsFor(const JobConfig& job, const v1::RecognizeResponse& answer,
                               const CellFrames& frames, const Reach& reach,
                               const HasLabel& has_label) {
  std::vector<Object> out;
  for (const v1::Detection& detection : answer.detections()) {
    if (!ObjectionTo(job, detection, has_label).empty()) continue;
    Object object{&detection, {}};
    for (const v1::GraspProposal& grasp : detection.grasps()) {
      if (IsWithinReach(reach, frames.world_base, grasp)) object.grasps.push_back(&grasp);
    }
    if (!object.grasps.empty() || detection.status() == v1::NO_GRASP) {
      out.push_back(std::move(object));
    }
  }
  std::ranges::stable_sort(
      out, {}, [](const Object& object) { return object.detection->touching() ? 1 : 0; });
  return out;
}

JobPose PoseOf(const v1::Detection& detection, v1::Grasp grasp) {
  JobPose out;
  out.object = detection.object();
  out.stable_pose = detection.stable_pose();
  out.score = detection.score();
  out.grasp = std::move(grasp);
  return out;
}

}  // namespace

std::vector<JobPose> PosesFor(const JobConfig& job, const v1::RecognizeResponse& answer,
                              const CellFrames& frames, const Reach& reach,
                              const HasLabel& has_label) {
  const Pose base_world = frames.world_base.inverse();
  std::vector<JobPose> out;
  for (const Object& object : ObjectsFor(job, answer, frames, reach, has_label)) {
    const Pose base_object = base_world * files::FromMessage(object.detection->refined_pose());
    std::vector<Pose> base_tcps;
    std::vector<v1::Grasp> grasps;
    base_tcps.reserve(object.grasps.size());
    grasps.reserve(object.grasps.size());
    for (const v1::GraspProposal* grasp : object.grasps) {
      base_tcps.push_back(base_world * files::FromMessage(grasp->tcp_pose()));
      grasps.push_back(grasp->grasp());
    }
    if (job.primary == JobPrimary::kObject) {
      JobPose pose = PoseOf(*object.detection, grasps.empty() ? v1::Grasp() : grasps.front());
      pose.base_primary = base_object;
      pose.base_related = std::move(base_tcps);
      pose.related_grasps = std::move(grasps);
      out.push_back(std::move(pose));
      continue;
    }
    for (std::size_t i = 0; i < object.grasps.size(); ++i) {
      JobPose pose = PoseOf(*object.detection, grasps[i]);
      pose.base_primary = base_tcps[i];
      pose.base_related = {base_object};
      out.push_back(std::move(pose));
    }
  }
  if (job.max_poses != 0 && out.size() > job.max_poses) out.resize(job.max_poses);
  return out;
}

std::string NoPoseReason(const JobConfig& job, const v1::RecognizeResponse& answer,
                         const HasLabel& has_label) {
  if (answer.detections().empty()) {
    return absl::StrCat("the frame shows no object: ", v1::RecognitionStatus_Name(answer.status()));
  }
  std::set<std::string> reasons;  // each once
  for (const v1::Detection& detection : answer.detections()) {
    const std::string objection = ObjectionTo(job, detection, has_label);
    reasons.insert(objection.empty() ? "no grasp of " + detection.object() + " is within reach"
                                     : objection);
  }
  const auto end = std::next(reasons.begin(),
                             static_cast<std::ptrdiff_t>(std::min(reasons.size(), kMaxReasons)));
  std::string out = "no object in the frame fits: " + absl::StrJoin(reasons.begin(), end, "; ");
  if (end == reasons.end()) return out;
  return absl::StrCat(out, "; and ", reasons.size() - kMaxReasons, " more");
}

}  // namespace graspdb::client
