#include "lab/experiment/experiment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <iterator>
#include <memory>
#include <numbers>
#include <utility>

#include "base/status_macros.h"
#include "recognition/threshold_proposals.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector3d;
using recognition::Points;

constexpr std::size_t kMaxKeptPoints = 500;
constexpr double kTableM = 0.004;  // lower points are the table

// Every n-th point, so that at most kMaxKeptPoints are left.
Points Thinned(const Points& points) {
  const std::size_t step = points.size() / kMaxKeptPoints + 1;
  Points out;
  for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

Eigen::Vector3f CenterOf(const rendering::MeasuredShape& shape) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : shape.points) box.extend(p);
  return box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.center());
}

// Points of the scan no farther than `radius_m` from `center` (world frame), without the table.
Points Around(const Vector3d& center, double radius_m, const recognition::Scan& scan,
              const recognition::Pose& world_sensor) {
  Points out;
  for (const Eigen::Vector3f& p : scan.points) {
    if (!p.allFinite() || p.z() <= 0) continue;
    const Vector3d world = world_sensor * p.cast<double>();
    if (!scan.segmented && (world.z() < kTableM || (world - center).norm() > radius_m)) continue;
    out.push_back(world.cast<float>());
  }
  return Thinned(out);
}

// Without a mesh, answers are measured against the taught model.
void MeasureTaught(Gallery* gallery, PartSet* set) {
  for (std::size_t i = 0; i < set->parts.size(); ++i) {
    if (set->shapes[i]) continue;
    const auto model = gallery->ModelOf(set->parts[i]);
    set->shapes[i] = std::make_shared<const rendering::MeasuredShape>(rendering::Measure(
        model ? *model : recognition::SurfaceModel({}, 0), set->parts[i].symmetry_order));
  }
}

// `taught` with the threshold of each stable pose from recognition::ProposeThresholds. Errors as
// there.
absl::StatusOr<recognition::CatalogueSnapshot> WithOwnThresholds(
    recognition::CatalogueSnapshot taught, const recognition::RecognitionParameters& parameters,
    const recognition::ThresholdProgress& report, Gallery* gallery) {
  ASSIGN_OR_RETURN(const auto proposals,
                   recognition::ProposeThresholds(
                       taught, *gallery, /*object=*/"", parameters, [] { return false; }, report));
  auto poses = *taught.stable_poses;
  for (const recognition::ThresholdProposal& proposal : proposals) {
    if (!proposal.min_score) continue;
    auto& pose = poses.at(proposal.stable_pose);
    auto changed = std::make_shared<recognition::TaughtStablePose>(*pose);
    changed->min_score = proposal.min_score;
    pose = std::move(changed);
  }
  taught.stable_poses = std::make_shared<const decltype(poses)>(std::move(poses));
  return taught;
}

// The taught catalogue with the thresholds of the run. A step without a name is not reported.
absl::StatusOr<recognition::CatalogueSnapshot> Known(recognition::CatalogueSnapshot taught,
                                                     const std::string& step,
                                                     const ExperimentRun& run, Gallery* gallery) {
  if (!run.own_thresholds) return taught;
  const auto report = [&](std::size_t done, std::size_t count) {
    if (run.report && !step.empty()) run.report(step, done + 1, count);
    return absl::OkStatus();
  };
  return WithOwnThresholds(std::move(taught), run.parameters, report, gallery);
}

// Scores the true poses of objects without a right answer.
void JudgeTruth(const recognition::Scan& scan, const PartSet& set, const ExperimentRun& run,
                Gallery* gallery, std::vector<Answer>* answers) {
  recognition::StageLog log;
  const auto segmentation = recognition::SegmentScan(
      scan, run.parameters.segmentation, run.parameters.descriptor, [] { return false; }, &log);
  if (!segmentation.ok()) return;
  for (Answer& answer : *answers) {
    const auto model = gallery->ModelOf(set.parts[answer.part]);
    if (!answer.known || !answer.posed || answer.strictly_right || !model) continue;
    answer.true_pose = ScoreTruth(scan, *segmentation, *model, answer.truth, run.parameters);
  }
}

absl::StatusOr<std::vector<Answer>> RunQuery(const ExperimentTrials& trials, std::size_t query,
                                             const recognition::CatalogueSnapshot& taught,
                                             const PartSet& set, const ExperimentRun& run,
                                             Gallery* gallery) {
  ASSIGN_OR_RETURN(auto trial, trials.queries.make(query));
  ASSIGN_OR_RETURN(const auto known, trials.leave_one_out
                                         ? Known(gallery->Snapshot(query), "", run, gallery)
                                         : absl::StatusOr<recognition::CatalogueSnapshot>(taught));
  const auto start = std::chrono::steady_clock::now();
  ASSIGN_OR_RETURN(auto recognition, recognition::Recognize(trial.scan, known, *gallery,
                                                            run.parameters, [] { return false; }));
  const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
  std::vector<Answer> out;
  for (std::size_t which = 0; which < trial.truth.size(); ++which) {
    out.push_back(JudgeAnswer(recognition, trial, which, set));
    Answer& answer = out.back();
    answer.scene = query;
    answer.milliseconds = took.count();
    answer.file = trial.file;
    // If it were right, there would be no pose to judge either.
    const bool is_lost = answer.known && !answer.object_right;
    if (is_lost && !gallery->HasFrame(set.parts[answer.part])) answer.posed = false;
  }
  if (run.judge_truth && !std::ranges::all_of(out, &Answer::strictly_right)) {
    JudgeTruth(trial.scan, set, run, gallery, &out);
  }
  return out;
}

// Fills `result->scans` for the `count` worst answers: the points above the table around the
// object, at most 500; all points of a segmented scan. Errors as those of `queries`.
absl::Status KeepScans(std::size_t count, const TrialSource& queries, CaseResult* result) {
  if (count == 0) return absl::OkStatus();
  std::vector<std::size_t> worst = WorstFirst(*result);
  worst.resize(std::min(worst.size(), count));
  for (const std::size_t i : worst) {
    const Answer& answer = result->answers[i];
    ASSIGN_OR_RETURN(const auto trial, queries.make(answer.scene));
    const rendering::MeasuredShape& shape = *result->set.shapes[answer.part];
    const Vector3d center = answer.truth * CenterOf(shape).cast<double>();
    result->scans[i] = Around(center, 0.6 * shape.diameter_m, trial.scan, answer.world_sensor);
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment, const PartSet& set,
                                   const ExperimentTrials& trials, const ExperimentRun& run,
                                   LastGallery* last) {
  CaseResult out{.experiment = experiment, .set = set};
  LastGallery own;
  ASSIGN_OR_RETURN(const auto taught,
                   (last != nullptr ? last : &own)->Teach(experiment, set, trials.teaching, run));
  Gallery& gallery = *taught;
  MeasureTaught(&gallery, &out.set);
  // If each query leaves a view out, the snapshot is made with the query.
  ASSIGN_OR_RETURN(
      const auto snapshot,
      trials.leave_one_out
          ? absl::StatusOr<recognition::CatalogueSnapshot>(gallery.Snapshot())
          : Known(gallery.Snapshot(), experiment.name + ": thresholds", run, &gallery));
  std::vector<std::vector<Answer>> answers(trials.queries.count);
  const auto query = [&](std::size_t i) -> absl::Status {
    ASSIGN_OR_RETURN(auto of_scene, RunQuery(trials, i, snapshot, out.set, run, &gallery));
    answers[i] = std::move(of_scene);
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(ForEach(answers.size(), experiment.name + ": queries", run, query));
  for (std::vector<Answer>& of_scene : answers) {
    std::ranges::move(of_scene, std::back_inserter(out.answers));
  }
  RETURN_IF_ERROR(KeepScans(run.kept_scans, trials.queries, &out));
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
    out.posed += a.posed;
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
  for (double* share : {&out.object_right, &out.ambiguous, &out.listed}) {
    *share /= at_least_one(out.known);
  }
  for (double* share : {&out.pose_right, &out.strictly_right}) *share /= at_least_one(out.posed);
  out.unknown_rejected /= at_least_one(out.unknown);
  out.mean_rotation_deg /= at_least_one(poses);
  out.mean_translation_mm /= at_least_one(poses);
  out.mean_ms /= at_least_one(result.answers.size());
  return out;
}

std::vector<std::size_t> WorstFirst(const CaseResult& result) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.answers.size(); ++i) {
    if (result.answers[i].known || !result.answers[i].object_right) order.push_back(i);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const Answer& x = result.answers[a];
    const Answer& y = result.answers[b];
    if (x.object_right != y.object_right) return !x.object_right;
    return x.error.hausdorff_m > y.error.hausdorff_m;
  });
  return order;
}

}  // namespace graspdb::lab
