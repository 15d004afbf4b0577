#include "lab/commands/eval_run.h"

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "lab/experiment/descriptor_comparison.h"
#include "lab/experiment/experiment.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/report/answer_drawings.h"
#include "lab/experiment/report/report_writer.h"
#include "lab/experiment/trials/capture_trials.h"
#include "lab/experiment/trials/frames_file.h"

namespace graspdb::lab {
namespace {

// The case that descriptors are compared on.
constexpr char kDescriptorCase[] = "paper";
constexpr char kCaptureSetCase[] = "captures";

void PrintParts(const PartSet& set) {
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    const rendering::MeasuredShape& shape = *set.shapes[i];
    std::cout << absl::StrFormat("%-60s diameter %.0f mm, %d turns alike%s\n",
                                 StablePoseName(set.parts[i]), shape.diameter_m * 1e3,
                                 shape.turns_rad.size(), shape.is_round ? ", round" : "");
  }
}

void PrintSummary(const CaseResult& result) {
  const CaseSummary s = Summarize(result);
  std::cout << absl::StrFormat("%-17s %5d queries  object %6.2f %%", result.experiment.name,
                               s.known, 100 * s.object_right);
  if (s.posed > 0) {
    if (s.posed < s.known) std::cout << absl::StrFormat("  of %d with a pose:", s.posed);
    std::cout << absl::StrFormat(
        "  pose %6.2f %%  strictly %6.2f %%  only listed %5.2f %%  turn %.3f deg  shift %.3f mm",
        100 * s.pose_right, 100 * s.strictly_right, 100 * s.listed, s.mean_rotation_deg,
        s.mean_translation_mm);
  }
  std::cout << absl::StrFormat("  ambiguous %5.2f %%  %.1f ms", 100 * s.ambiguous, s.mean_ms);
  if (s.unknown > 0) {
    std::cout << absl::StrFormat("  of %d unknown rejected %.2f %%", s.unknown,
                                 100 * s.unknown_rejected);
  }
  std::cout << "\n" << std::flush;
}

void PrintDescriptors(const std::vector<DescriptorFigures>& figures) {
  for (const DescriptorFigures& f : figures) {
    std::cout << absl::StrFormat(
        "%-9s %-11s turned over %6.2f %%  another object %6.2f %%  of %d\n", f.descriptor,
        f.distance, 100 * MeanFalseRecognition(f), 100 * f.object_wrong, f.query_count);
  }
}

// The wrong answers.
void PrintWrong(const CaseResult& result) {
  for (const Answer& a : result.answers) {
    if (!IsWrong(a)) continue;
    std::cout << absl::StrFormat("  %5d %s%s -> %s, score %.3f, ADD-S %.1f mm, farthest %.1f mm\n",
                                 a.scene, a.file.empty() ? "" : a.file + ": ",
                                 StablePoseName(result.set.parts[a.part]),
                                 a.stable_pose.empty() ? "nothing" : a.stable_pose, a.score,
                                 a.error.add_s_m * 1e3, a.error.hausdorff_m * 1e3);
    std::cout << "        answer: " << TextOf(a.evidence, a.features) << "\n";
    if (a.true_pose) std::cout << "        true pose: " << TextOf(*a.true_pose) << "\n";
  }
}

// The chosen cases, in their order.
std::vector<ExperimentCase> ChosenCases(const EvalArguments& arguments) {
  std::vector<ExperimentCase> out;
  for (ExperimentCase& experiment : ExperimentCases()) {
    const bool named = std::ranges::find(arguments.cases, experiment.name) != arguments.cases.end();
    if (arguments.cases.empty() ? experiment.only_named : !named) continue;
    experiment.trials_per_part = arguments.trials;
    experiment.seed = arguments.seed;
    out.push_back(std::move(experiment));
  }
  return out;
}

// None when no report is wanted.
absl::StatusOr<std::optional<ReportWriter>> WriterOf(const EvalArguments& arguments) {
  if (arguments.out.empty()) return std::nullopt;
  ASSIGN_OR_RETURN(auto writer, ReportWriter::Create(arguments.out, arguments.command));
  return writer;
}

// Cases one after the other, with a progress line, their figures and the report.
class Runner {
 public:
  static absl::StatusOr<std::unique_ptr<Runner>> Create(const EvalArguments& arguments) {
    ASSIGN_OR_RETURN(auto writer, WriterOf(arguments));
    return std::unique_ptr<Runner>(new Runner(arguments, std::move(writer)));
  }

  absl::Status Run(const ExperimentCase& experiment, const PartSet& set,
                   const ExperimentTrials& trials, bool with_descriptors) {
    if (with_descriptors) {
      auto figures = CompareDescriptors(set, trials, run_);
      progress_.reset();
      if (!figures.ok()) return figures.status();
      PrintDescriptors(*figures);
      RETURN_IF_ERROR(writer_ ? writer_->SetDescriptors(*figures) : absl::OkStatus());
    }
    const auto result = RunCase(experiment, set, trials, run_, &taught_);
    progress_.reset();
    if (!result.ok()) return result.status();
    PrintSummary(*result);
    if (arguments_.list) PrintWrong(*result);
    return writer_ ? writer_->Add(*result) : absl::OkStatus();
  }

  void Finish() const {
    if (!writer_) return;
    const absl::Status made = MakeReportPage(writer_->folder());
    if (!made.ok()) std::cerr << "graspdb: " << made.message() << "\n";
    const std::string name = made.ok() ? "report.html" : "report.json";
    std::cout << "report: " << (writer_->folder() / name).string() << "\n";
  }

 private:
  Runner(const EvalArguments& arguments, std::optional<ReportWriter> writer)
      : arguments_(arguments), writer_(std::move(writer)) {
    run_.parameters.matching = arguments.matching;
    run_.parameters.scene.verify = !arguments.without_image;
    run_.parameters.scene.search = !arguments.without_search && !arguments.without_image;
    run_.judge_truth = arguments.list;
    run_.own_thresholds = arguments.own_thresholds;
    run_.kept_scans = writer_ ? kDrawnAnswers : 0;
    run_.report = [this](const std::string& step, std::size_t done, std::size_t total) {
      if (step != running_) progress_ = std::make_unique<client::ProgressLine>();
      running_ = step;
      progress_->Report(static_cast<int>(done), static_cast<int>(total));
    };
  }

  const EvalArguments& arguments_;
  std::optional<ReportWriter> writer_;
  ExperimentRun run_;
  LastGallery taught_;
  std::unique_ptr<client::ProgressLine> progress_;
  std::string running_;
};

absl::Status RunCaptureSet(const EvalArguments& arguments) {
  ASSIGN_OR_RETURN(const auto loaded,
                   LoadCaptureTrials(arguments.inputs.front(), arguments.leave_one_out));
  const std::string settings = absl::StrFormat(
      "Capture set %s: %d captures taught, %s.", arguments.inputs.front(),
      loaded.trials.teaching.count,
      arguments.leave_one_out ? "each recognised without its own view"
                              : absl::StrCat(loaded.trials.queries.count, " recognised"));
  ASSIGN_OR_RETURN(auto runner, Runner::Create(arguments));
  const ExperimentCase experiment = {
      .name = kCaptureSetCase, .settings = settings, .is_simulated = false};
  absl::Status status = runner->Run(experiment, loaded.set, loaded.trials, arguments.descriptors);
  if (status.ok()) runner->Finish();
  return status;
}

absl::Status RunMeshes(const EvalArguments& arguments) {
  ASSIGN_OR_RETURN(auto runner, Runner::Create(arguments));
  const std::vector<std::filesystem::path> paths(arguments.inputs.begin(), arguments.inputs.end());
  ASSIGN_OR_RETURN(const auto all, RestingParts(paths, arguments.unit_m, arguments.selection));
  if (arguments.list) PrintParts(all);
  for (const ExperimentCase& experiment : ChosenCases(arguments)) {
    ASSIGN_OR_RETURN(const auto set,
                     experiment.parts == PartChoice::kDropPoses
                         ? DropPoses(paths, arguments.unit_m,
                                     {.min_length_m = arguments.choices.min_length_m,
                                      .max_length_m = arguments.choices.max_length_m,
                                      .falls = experiment.trials_per_part,
                                      .seed = experiment.seed})
                         : Choose(all, experiment.parts, arguments.choices));
    ASSIGN_OR_RETURN(const auto trials, RenderedTrials(experiment, set));
    RETURN_IF_ERROR(runner->Run(experiment, set, trials,
                                arguments.descriptors && experiment.name == kDescriptorCase));
  }
  runner->Finish();
  return absl::OkStatus();
}

}  // namespace

absl::Status RunEval(const EvalArguments& arguments) {
  const auto is_set = [](const std::string& input) {
    std::error_code ignored;  // an unreadable path is read as a file, which returns the error
    return std::filesystem::is_directory(input, ignored);
  };
  const auto sets = std::ranges::count_if(arguments.inputs, is_set);
  if (sets == 0 && !arguments.leave_one_out) return RunMeshes(arguments);
  if (sets == 1 && arguments.inputs.size() == 1) {
    if (HasFrames(arguments.inputs.front())) return RunFrames(arguments);
    return RunCaptureSet(arguments);
  }
  return absl::InvalidArgumentError(
      sets == 0 ? "--leave-one-out needs a capture set; give its folder"
                : "a folder cannot be combined with other inputs; give one folder or mesh files");
}

}  // namespace graspdb::lab
