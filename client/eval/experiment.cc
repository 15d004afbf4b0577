#include "client/eval/experiment.h"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <numbers>

#include "client/eval/kept_scans.h"

namespace graspdb::client {
namespace {

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
      answers[i].push_back(JudgeAnswer(*recognition, *trial, which, set));
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
    out.listed += a.listed;
    if (!a.pose_right) continue;
    ++poses;
    out.mean_rotation_deg += a.error.rotation_rad * 180 / std::numbers::pi;
    out.mean_translation_mm += a.error.translation_m * 1000;
  }
  const auto at_least_one = [](auto n) { return std::max(1.0, static_cast<double>(n)); };
  for (double* share :
       {&out.object_right, &out.pose_right, &out.strictly_right, &out.ambiguous, &out.listed}) {
    *share /= at_least_one(out.known);
  }
  out.unknown_rejected /= at_least_one(out.unknown);
  out.mean_rotation_deg /= at_least_one(poses);
  out.mean_translation_mm /= at_least_one(poses);
  out.mean_ms /= at_least_one(result.answers.size());
  return out;
}

}  // namespace graspdb::client
