#include "client/eval/eval_command.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <optional>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/eval/command_text.h"
#include "client/eval/descriptor_comparison.h"
#include "client/eval/experiment.h"
#include "client/eval/part_set.h"
#include "client/eval/report/match_drawing.h"
#include "client/eval/report/report_writer.h"
#include "client/sensors/progress_line.h"

namespace graspdb::client {
namespace {

constexpr char kDescription[] =
    "Measure how often the answer is right, on meshes that a simulated Kinect sees.\n"
    "Each mesh is taught on a turntable in the attitude in which it most often comes to rest, and "
    "asked about in new scenes. No server is needed.";

constexpr char kFooter[] =
    "Right: ADD-S under 5 % of the diameter. Strictly right: no point farther off than 8 mm, or\n"
    "6 % of the diameter.\n"
    "Examples:\n"
    "  graspdb eval meshes/*.ply\n"
    "  graspdb eval meshes/*.ply --out report             # then open report/report.html\n"
    "  graspdb eval meshes/*.ply --case hidden-20,hidden-40 --trials 8 --list";

// The case that descriptors are compared on.
constexpr char kDescriptorCase[] = "paper";

struct Arguments {
  std::vector<std::string> meshes;
  Choices choices;
  std::vector<std::string> cases;
  double unit_m = 1;
  MeshSelection selection{.attitudes = 3};
  int trials = 24;
  std::uint64_t seed = 1;
  recognition::MatchingParameters matching;
  bool descriptors = false;
  bool list = false;
  std::string out;      // folder; empty: no report
  std::string command;  // as it could be typed again
};

void PrintParts(const PartSet& set) {
  for (std::size_t i = 0; i < set.parts.size(); ++i) {
    const MeasuredShape& shape = *set.shapes[i];
    std::cout << absl::StrFormat("%-60s diameter %.0f mm, %d turns alike%s\n",
                                 StablePoseName(set.parts[i]), shape.diameter_m * 1e3,
                                 shape.turns_rad.size(), shape.is_round ? ", round" : "");
  }
}

void PrintSummary(const CaseResult& result) {
  const CaseSummary s = Summarize(result);
  std::cout << absl::StrFormat(
      "%-14s %5d asked  object %6.2f %%  pose %6.2f %%  strictly %6.2f %%  ambiguous %5.2f %%  "
      "only listed %5.2f %%  turn %.3f deg  shift %.3f mm  %.1f ms",
      result.experiment.name, s.known, 100 * s.object_right, 100 * s.pose_right,
      100 * s.strictly_right, 100 * s.ambiguous, 100 * s.listed, s.mean_rotation_deg,
      s.mean_translation_mm, s.mean_ms);
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
        f.distance, 100 * MeanFalseRecognition(f), 100 * f.object_wrong, f.asked);
  }
}

// The answers that were not strictly right.
void PrintWrong(const CaseResult& result) {
  for (const Answer& a : result.answers) {
    if (a.known ? a.strictly_right : a.object_right) continue;
    std::cout << absl::StrFormat("  %5d %s -> %s, score %.3f, ADD-S %.1f mm, farthest %.1f mm\n",
                                 a.scene, StablePoseName(result.set.parts[a.part]),
                                 a.stable_pose.empty() ? "nothing" : a.stable_pose, a.score,
                                 a.error.add_s_m * 1e3, a.error.hausdorff_m * 1e3);
  }
}

// The chosen cases, in their order.
std::vector<ExperimentCase> ChosenCases(const Arguments& arguments) {
  std::vector<ExperimentCase> out;
  for (ExperimentCase& experiment : ExperimentCases()) {
    if (!arguments.cases.empty() &&
        std::ranges::find(arguments.cases, experiment.name) == arguments.cases.end()) {
      continue;
    }
    experiment.trials_per_part = arguments.trials;
    experiment.seed = arguments.seed;
    out.push_back(std::move(experiment));
  }
  return out;
}

// None when no report is wanted.
absl::StatusOr<std::optional<ReportWriter>> WriterOf(const Arguments& arguments) {
  if (arguments.out.empty()) return std::nullopt;
  auto writer = ReportWriter::Create(arguments.out, arguments.command);
  if (!writer.ok()) return writer.status();
  return *std::move(writer);
}

absl::Status Run(const Arguments& arguments) {
  auto writer = WriterOf(arguments);
  if (!writer.ok()) return writer.status();
  const std::vector<std::filesystem::path> paths(arguments.meshes.begin(), arguments.meshes.end());
  const auto all = RestingParts(paths, arguments.unit_m, arguments.selection);
  if (!all.ok()) return all.status();
  if (arguments.list) PrintParts(*all);
  ExperimentRun run;
  run.parameters.matching = arguments.matching;
  run.kept_scans = *writer ? kDrawnAnswers : 0;
  std::unique_ptr<ProgressLine> progress;
  std::string running;
  run.report = [&](const std::string& step, std::size_t done, std::size_t total) {
    if (step != running) progress = std::make_unique<ProgressLine>();
    running = step;
    progress->Report(static_cast<int>(done), static_cast<int>(total));
  };
  for (const ExperimentCase& experiment : ChosenCases(arguments)) {
    const auto set = Choose(*all, experiment.parts, arguments.choices);
    if (!set.ok()) return set.status();
    if (arguments.descriptors && experiment.name == kDescriptorCase) {
      auto figures = CompareDescriptors(experiment, *set, run);
      progress.reset();
      if (!figures.ok()) return figures.status();
      PrintDescriptors(*figures);
      absl::Status put = *writer ? (*writer)->SetDescriptors(*figures) : absl::OkStatus();
      if (!put.ok()) return put;
    }
    const auto result = RunCase(experiment, *set, run);
    progress.reset();
    if (!result.ok()) return result.status();
    PrintSummary(*result);
    if (arguments.list) PrintWrong(*result);
    absl::Status added = *writer ? (*writer)->Add(*result) : absl::OkStatus();
    if (!added.ok()) return added;
  }
  if (*writer) std::cout << "report: " << (*writer)->page_path().string() << "\n";
  return absl::OkStatus();
}

std::vector<std::string> CaseNames() {
  std::vector<std::string> names;
  for (const ExperimentCase& experiment : ExperimentCases()) names.push_back(experiment.name);
  return names;
}

}  // namespace

void AddEvalCommand(CLI::App& app, std::function<absl::Status()>* action) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("eval", kDescription);
  command->footer(kFooter);
  command->add_option("meshes", arguments->meshes, "Mesh files: PLY, OBJ, STL")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--case", arguments->cases, "Cases to run; all without it")
      ->delimiter(',')
      ->check(CLI::IsMember(CaseNames()));
  command
      ->add_option("--objects", arguments->choices.main,
                   "Meshes of the main cases, by file name without ending; all that are not round "
                   "without it")
      ->delimiter(',');
  command->add_option("--unit-m", arguments->unit_m, "Length of the meshes' unit in metres")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--min-length-m", arguments->choices.min_length_m,
                   "Smaller meshes are left out of the case \"everything\"")
      ->capture_default_str();
  command
      ->add_option("--max-length-m", arguments->choices.max_length_m,
                   "Larger meshes are left out of the case \"everything\"")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Of scenes and noise")->capture_default_str();
  command
      ->add_option("--attitudes", arguments->selection.attitudes,
                   "Attitudes of a mesh in the case \"everything\"")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--trials", arguments->trials, "Random scenes for each attitude")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option("--min-score", arguments->matching.min_score,
                   "Answers that are less sure are rejected; 0 rejects none")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--verified-views", arguments->matching.verified_view_count,
                   "Nearest views that are verified; 1: the paper's way")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--descriptors", arguments->descriptors,
                    "Also compare descriptors and distances, without verification, on the case "
                    "\"paper\"");
  command->add_flag("--list", arguments->list, "Also list the objects, and what was not right");
  command->add_option("--out", arguments->out,
                      "Folder for a report: report.html to read, cases.md for documents, "
                      "report.json and poses as the BOP challenge takes them for programs; written "
                      "again after every case");
  command->callback([command, arguments, action] {
    arguments->command = CommandText(*command);
    *action = [arguments] { return Run(*arguments); };
  });
}

}  // namespace graspdb::client
