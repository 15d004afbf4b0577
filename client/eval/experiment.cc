#include "client/eval/experiment.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <numbers>

#include "client/eval/kept_scans.h"

namespace graspdb::client {
namespace {

using recognition::Detection;
using recognition::Pose;

absl::Status Teach(const ExperimentCase& experiment, const PartSet& set, const ExperimentRun& run,
                   Gallery* gallery) {
  auto plan = PlanTeaching(experiment, set);
  if (!plan.ok()) return plan.status();
  auto renderer = TrialRenderer::Create(set.parts, experiment.taught.camera);
  if (!renderer.ok()) return renderer.status();
  ExperimentRun alone = run;
  alone.workers = 1;
  return ForEach(plan->size(), experiment.name + ": teaching", alone, [&](std::size_t i) {
    auto trial = renderer->Render((*plan)[i]);
    return trial.ok() ? gallery->Teach(*trial) : trial.status();
  });
}

// The detection nearest to what the camera sees of a thing; null without detections.
const Detection* DetectionAt(const recognition::Recognition& recognition,
                             const Eigen::Vector3d& seen) {
  if (recognition.detections.empty()) return nullptr;
  return &*std::ranges::min_element(recognition.detections, {}, [&](const Detection& d) {
    return (d.centroid - seen).head<2>().norm();
  });
}

// Judges the pose, and the further ones where the answer says that it is ambiguous.
void JudgePoses(const Detection& detection, std::size_t answered, const PartSet& set,
                Answer* answer) {
  const MeasuredShape& shape = *set.shapes[answer->part];
  const auto as_asked = [&](const Pose& pose) {
    return AsIn(set.object_mesh[answer->part], set.object_mesh[answered], pose);
  };
  answer->found = as_asked(detection.refined_pose);
  answer->error = ErrorOf(shape, answer->truth, answer->found);
  for (const Pose& pose : detection.equivalent_poses) {
    if (IsStrictlyRight(shape, answer->error)) break;
    if (detection.outcome != recognition::RecognitionOutcome::kAmbiguous) break;
    const PoseError error = ErrorOf(shape, answer->truth, as_asked(pose));
    if (!IsStrictlyRight(shape, error)) continue;
    answer->error = error;
    answer->by_equivalent = true;
  }
  answer->pose_right = IsRight(shape, answer->error);
  answer->strictly_right = IsStrictlyRight(shape, answer->error);
}

Answer Judge(const recognition::Recognition& recognition, const Trial& trial, std::size_t which,
             const PartSet& set) {
  const Placement& truth = trial.truth[which];
  Answer out{.part = truth.part,
             .known = truth.part < set.taught_count,
             .outcome = recognition.outcome,
             .truth = truth.world_object};
  const Detection* detection = DetectionAt(recognition, trial.seen[which]);
  if (detection != nullptr) {
    out.outcome = detection->outcome;
    out.score = detection->score;
    out.doubt = detection->doubt;
    out.candidates = detection->candidates;
    out.found = detection->refined_pose;
  }
  if (detection == nullptr || !detection->view) {
    out.object_right = !out.known;
    return out;
  }
  out.stable_pose = detection->view->stable_pose;
  out.view = detection->view->name;
  if (!out.known || detection->view->object != "objects/" + set.parts[out.part].object_id) {
    return out;
  }
  out.object_right = true;
  const auto answered = std::ranges::find(set.parts, out.stable_pose, StablePoseName);
  JudgePoses(*detection, static_cast<std::size_t>(answered - set.parts.begin()), set, &out);
  return out;
}

}  // namespace

absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment, const PartSet& set,
                                   const ExperimentRun& run) {
  Gallery gallery(set.parts, run.parameters);
  if (absl::Status taught = Teach(experiment, set, run, &gallery); !taught.ok()) return taught;
  auto plan = PlanQuestions(experiment, set);
  if (!plan.ok()) return plan.status();
  auto renderer = TrialRenderer::Create(set.parts, experiment.asked.camera);
  if (!renderer.ok()) return renderer.status();
  const recognition::CatalogueSnapshot snapshot = gallery.Snapshot();

  std::vector<std::vector<Answer>> answers(plan->size());
  const auto ask = [&](std::size_t i) -> absl::Status {
    auto trial = renderer->Render((*plan)[i], ObstacleOf(experiment, i));
    if (!trial.ok()) return trial.status();
    const auto start = std::chrono::steady_clock::now();
    auto recognition = recognition::Recognize(trial->scan, snapshot, gallery, run.parameters,
                                              [] { return false; });
    if (!recognition.ok()) return recognition.status();
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    for (std::size_t which = 0; which < trial->truth.size(); ++which) {
      answers[i].push_back(Judge(*recognition, *trial, which, set));
      answers[i].back().scene = i;
      answers[i].back().milliseconds = took.count();
      answers[i].back().world_sensor = (*plan)[i].world_sensor;
    }
    return absl::OkStatus();
  };
  if (absl::Status s = ForEach(plan->size(), experiment.name + ": asking", run, ask); !s.ok()) {
    return s;
  }
  CaseResult out{.experiment = experiment, .set = set};
  for (std::vector<Answer>& of_scene : answers) {
    std::ranges::move(of_scene, std::back_inserter(out.answers));
  }
  if (absl::Status s = KeepScans(run.kept_scans, *plan, *renderer, &out); !s.ok()) return s;
  return out;
}

CaseSummary Summarize(const CaseResult& result) {
  CaseSummary out;
  int poses = 0;
  for (const Answer& a : result.answers) {
    out.mean_ms += a.milliseconds;
    if (!a.known) {
      ++out.unknown;
      out.unknown_rejected += a.object_right;
      continue;
    }
    ++out.known;
    out.object_right += a.object_right;
    out.pose_right += a.pose_right;
    out.strictly_right += a.strictly_right;
    out.ambiguous += a.outcome == recognition::RecognitionOutcome::kAmbiguous;
    if (!a.pose_right) continue;
    ++poses;
    out.mean_rotation_deg += a.error.rotation_rad * 180 / std::numbers::pi;
    out.mean_translation_mm += a.error.translation_m * 1000;
  }
  const auto at_least_one = [](auto n) { return std::max(1.0, static_cast<double>(n)); };
  for (double* share : {&out.object_right, &out.pose_right, &out.strictly_right, &out.ambiguous}) {
    *share /= at_least_one(out.known);
  }
  out.unknown_rejected /= at_least_one(out.unknown);
  out.mean_rotation_deg /= at_least_one(poses);
  out.mean_translation_mm /= at_least_one(poses);
  out.mean_ms /= at_least_one(result.answers.size());
  return out;
}

}  // namespace graspdb::client
