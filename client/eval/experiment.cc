#include "client/eval/experiment.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <numbers>
#include <thread>

namespace graspdb::client {
namespace {

using recognition::Detection;
using recognition::Pose;

// Calls `work` for 0 … count - 1 on several threads; the first error ends it.
absl::Status ForEach(std::size_t count, const std::string& step, const ExperimentRun& run,
                     const std::function<absl::Status(std::size_t)>& work) {
  std::atomic<std::size_t> next = 0;
  std::mutex mutex;  // guards done, failure and the reports
  std::size_t done = 0;
  absl::Status failure;
  const auto loop = [&] {
    for (std::size_t i = next++; i < count; i = next++) {
      absl::Status status = run.cancelled && run.cancelled()
                                ? absl::CancelledError("stopped; nothing was written")
                                : work(i);
      const std::lock_guard lock(mutex);
      failure.Update(status);
      if (!failure.ok()) return;
      if (run.report) run.report(step, ++done, count);
    }
  };
  std::vector<std::thread> workers;
  for (int i = 1; i < run.workers; ++i) workers.emplace_back(loop);
  loop();
  for (std::thread& worker : workers) worker.join();
  return failure;
}

absl::Status Teach(const ExperimentCase& experiment, const std::vector<Workpiece>& parts,
                   const ExperimentRun& run, Gallery* gallery) {
  auto plan = PlanTeaching(experiment, parts);
  if (!plan.ok()) return plan.status();
  auto renderer = TrialRenderer::Create(parts, experiment.taught.camera);
  if (!renderer.ok()) return renderer.status();
  ExperimentRun alone = run;
  alone.workers = 1;
  return ForEach(plan->size(), experiment.name + ": teaching", alone, [&](std::size_t i) {
    auto trial = renderer->Render((*plan)[i]);
    return trial.ok() ? gallery->Teach(*trial) : trial.status();
  });
}

// The detection nearest to where the object stands; null without detections.
const Detection* MainDetection(const recognition::Recognition& recognition, const Pose& truth) {
  if (recognition.detections.empty()) return nullptr;
  return &*std::ranges::min_element(recognition.detections, {}, [&](const Detection& d) {
    return (d.centroid - truth.translation()).head<2>().norm();
  });
}

Answer Judge(const recognition::Recognition& recognition, const Placement& truth,
             const std::vector<Workpiece>& parts, const std::vector<MeasuredShape>& shapes) {
  Answer out{.part = truth.part, .outcome = recognition.outcome, .truth = truth.world_object};
  const Detection* main = MainDetection(recognition, truth.world_object);
  if (main == nullptr) return out;
  out.outcome = main->outcome;
  if (!main->view) return out;
  out.score = main->score;
  out.stable_pose = main->view->stable_pose;
  out.found = main->refined_pose;
  const Workpiece& part = parts[truth.part];
  out.object_right = main->view->object == "objects/" + part.object_id;
  if (out.stable_pose != StablePoseName(part)) return out;
  out.error = ErrorOf(shapes[truth.part], truth.world_object, main->refined_pose);
  out.pose_right = IsRight(shapes[truth.part], out.error);
  out.strictly_right = IsStrictlyRight(shapes[truth.part], out.error);
  return out;
}

}  // namespace

absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment,
                                   const std::vector<Workpiece>& parts,
                                   const std::vector<MeasuredShape>& shapes,
                                   const ExperimentRun& run) {
  Gallery gallery(parts, run.parameters);
  if (absl::Status taught = Teach(experiment, parts, run, &gallery); !taught.ok()) return taught;
  auto plan = PlanQuestions(experiment, parts);
  if (!plan.ok()) return plan.status();
  auto renderer = TrialRenderer::Create(parts, experiment.asked.camera);
  if (!renderer.ok()) return renderer.status();
  const recognition::CatalogueSnapshot snapshot = gallery.Snapshot();

  CaseResult out{.name = experiment.name, .answers = std::vector<Answer>(plan->size())};
  absl::Status asked =
      ForEach(plan->size(), experiment.name + ": asking", run, [&](std::size_t i) -> absl::Status {
        auto trial = renderer->Render((*plan)[i], ObstacleOf(experiment, i));
        if (!trial.ok()) return trial.status();
        const auto start = std::chrono::steady_clock::now();
        auto recognition = recognition::Recognize(trial->scan, snapshot, gallery, run.parameters,
                                                  [] { return false; });
        if (!recognition.ok()) return recognition.status();
        const std::chrono::duration<double, std::milli> took =
            std::chrono::steady_clock::now() - start;
        out.answers[i] = Judge(*recognition, trial->truth.front(), parts, shapes);
        out.answers[i].milliseconds = took.count();
        return absl::OkStatus();
      });
  if (!asked.ok()) return asked;
  return out;
}

CaseSummary Summarize(const CaseResult& result) {
  CaseSummary out;
  int poses = 0;
  for (const Answer& a : result.answers) {
    out.object_right += a.object_right;
    out.pose_right += a.pose_right;
    out.strictly_right += a.strictly_right;
    out.mean_ms += a.milliseconds;
    if (!a.pose_right) continue;
    ++poses;
    out.mean_rotation_deg += a.error.rotation_rad * 180 / std::numbers::pi;
    out.mean_translation_mm += a.error.translation_m * 1000;
  }
  const double n = std::max<double>(1, static_cast<double>(result.answers.size()));
  const double right = std::max(1, poses);
  return {out.object_right / n,
          out.pose_right / n,
          out.strictly_right / n,
          out.mean_rotation_deg / right,
          out.mean_translation_mm / right,
          out.mean_ms / n};
}

}  // namespace graspdb::client
