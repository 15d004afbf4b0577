#include "lab/experiment/answer.h"

#include <algorithm>

#include "lab/experiment/gallery.h"

namespace graspdb::lab {
namespace {

using recognition::Detection;
using recognition::Pose;

// One way to read an answer.
struct Reading {
  const recognition::TaughtView* view = nullptr;
  Pose world_object = Pose::Identity();
};

// The answer itself first; the further readings if it is ambiguous.
std::vector<Reading> ReadingsOf(const Detection& detection) {
  std::vector<Reading> out = {{detection.view.get(), detection.refined_pose}};
  if (detection.outcome != recognition::RecognitionOutcome::kAmbiguous) return out;
  for (const Pose& pose : detection.equivalent_poses) out.push_back({detection.view.get(), pose});
  for (const recognition::Alternative& a : detection.alternatives) {
    out.push_back({a.view.get(), a.world_object});
  }
  return out;
}

// The nearest to the camera if the true pose is unknown.
const Detection* DetectionOf(const recognition::Recognition& recognition, const Trial& trial,
                             std::size_t which) {
  if (recognition.detections.empty()) return nullptr;
  if (!trial.posed) return &recognition.detections.front();
  const Eigen::Vector3d& seen = trial.seen[which];
  return &*std::ranges::min_element(recognition.detections, {}, [&](const Detection& d) {
    return (d.centroid - seen).head<2>().norm();
  });
}

Answer JudgeReading(const Reading& reading, const PartSet& set, Answer answer) {
  answer.stable_pose = reading.view->stable_pose;
  answer.view = reading.view->name;
  answer.found = reading.world_object;
  if (!answer.known || reading.view->object != ObjectName(set.parts[answer.part])) return answer;
  answer.object_right = true;
  answer.posed = answer.posed && reading.view->shares_frame;
  if (!answer.posed) return answer;
  const rendering::MeasuredShape& shape = *set.shapes[answer.part];
  const auto answered = static_cast<std::size_t>(
      std::ranges::find(set.parts, answer.stable_pose, StablePoseName) - set.parts.begin());
  // Both stable poses are the same mesh at rest.
  answer.found =
      reading.world_object * set.object_mesh[answered] * set.object_mesh[answer.part].inverse();
  answer.error = rendering::ErrorOf(shape, answer.truth, answer.found);
  answer.pose_right = rendering::IsRight(shape, answer.error.add_s_m);
  answer.strictly_right = rendering::IsStrictlyRight(shape, answer.error);
  return answer;
}

}  // namespace

bool IsWrong(const Answer& answer) {
  return !(answer.known && answer.posed ? answer.strictly_right : answer.object_right);
}

Answer JudgeAnswer(const recognition::Recognition& recognition, const Trial& trial,
                   std::size_t which, const PartSet& set) {
  const rendering::Placement& truth = trial.truth[which];
  Answer seen{.part = truth.part,
              .known = set.IsTaught(truth.part),
              .posed = trial.posed,
              .outcome = recognition.outcome,
              .world_sensor = recognition.world_sensor,
              .truth = truth.world_object};
  const Detection* detection = DetectionOf(recognition, trial, which);
  if (detection != nullptr) {
    seen.outcome = detection->outcome;
    seen.touching = detection->touching;
    seen.score = detection->score;
    seen.features = detection->features;
    seen.evidence = detection->evidence;
    seen.voxels = detection->point_count;
    seen.candidates = detection->candidates;
    seen.found = detection->refined_pose;
  }
  if (detection == nullptr || !detection->view) {
    seen.object_right = !seen.known;
    return seen;
  }
  const std::vector<Reading> readings = ReadingsOf(*detection);
  Answer first = JudgeReading(readings.front(), set, seen);
  if (first.strictly_right || (first.object_right && !first.posed)) return first;
  for (std::size_t i = 1; i < readings.size(); ++i) {
    const Answer further = JudgeReading(readings[i], set, seen);
    if (!further.strictly_right) continue;
    first.object_right = first.pose_right = first.strictly_right = first.listed = true;
    first.error = further.error;
    break;
  }
  return first;
}

}  // namespace graspdb::lab
