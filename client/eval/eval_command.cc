#include "client/eval/eval_command.h"

#include <algorithm>
#include <iostream>
#include <memory>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/eval/experiment.h"
#include "client/eval/mesh_parts.h"
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
    "  graspdb eval meshes/*.ply --case hidden-20,hidden-40 --trials 8 --list";

struct Arguments {
  std::vector<std::string> meshes;
  std::vector<std::string> cases;
  int attitudes = 1;
  int trials = 24;
  int verified_views = 20;
  bool list = false;
};

void PrintParts(const std::vector<Workpiece>& parts, const std::vector<MeasuredShape>& shapes) {
  for (std::size_t i = 0; i < parts.size(); ++i) {
    std::cout << absl::StrFormat("%-60s diameter %.0f mm, %d turns alike\n",
                                 StablePoseName(parts[i]), shapes[i].diameter_m * 1e3,
                                 shapes[i].turns_rad.size());
  }
}

void PrintSummary(const CaseResult& result) {
  const CaseSummary s = Summarize(result);
  std::cout << absl::StrFormat(
                   "%-14s %5d asked  object %6.2f %%  pose %6.2f %%  strictly %6.2f %%  turn %.3f "
                   "deg  shift %.3f mm  %.1f ms\n",
                   result.name, result.answers.size(), 100 * s.object_right, 100 * s.pose_right,
                   100 * s.strictly_right, s.mean_rotation_deg, s.mean_translation_mm, s.mean_ms)
            << std::flush;
}

// The answers that were not strictly right.
void PrintWrong(const CaseResult& result, const std::vector<Workpiece>& parts) {
  for (std::size_t i = 0; i < result.answers.size(); ++i) {
    const Answer& a = result.answers[i];
    if (a.strictly_right) continue;
    std::cout << absl::StrFormat("  %5d %s -> %s, score %.3f, ADD-S %.1f mm, farthest %.1f mm\n", i,
                                 StablePoseName(parts[a.part]),
                                 a.stable_pose.empty() ? "nothing" : a.stable_pose, a.score,
                                 a.error.add_s_m * 1e3, a.error.hausdorff_m * 1e3);
  }
}

absl::Status Run(const Arguments& arguments) {
  const std::vector<std::filesystem::path> paths(arguments.meshes.begin(), arguments.meshes.end());
  const auto parts = RestingParts(paths, 1, {.attitudes = arguments.attitudes});
  if (!parts.ok()) return parts.status();
  std::vector<MeasuredShape> shapes;
  shapes.reserve(parts->size());
  for (const Workpiece& part : *parts) shapes.push_back(Measure(part));
  if (arguments.list) PrintParts(*parts, shapes);
  ExperimentRun run;
  run.parameters.matching.verified_view_count = arguments.verified_views;
  for (ExperimentCase& experiment : ExperimentCases()) {
    const bool chosen =
        arguments.cases.empty() ||
        std::ranges::find(arguments.cases, experiment.name) != arguments.cases.end();
    if (!chosen) continue;
    experiment.trials_per_part = arguments.trials;
    auto progress = std::make_unique<ProgressLine>();
    std::string running;
    run.report = [&](const std::string& step, std::size_t done, std::size_t total) {
      if (step != running) progress = std::make_unique<ProgressLine>();
      running = step;
      progress->Report(static_cast<int>(done), static_cast<int>(total));
    };
    const auto result = RunCase(experiment, *parts, shapes, run);
    progress.reset();
    if (!result.ok()) return result.status();
    PrintSummary(*result);
    if (arguments.list) PrintWrong(*result, *parts);
  }
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
  command->add_option("meshes", arguments->meshes, "Mesh files in metres: PLY, OBJ, STL")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--case", arguments->cases, "Cases to run; all without it")
      ->delimiter(',')
      ->check(CLI::IsMember(CaseNames()));
  command->add_option("--attitudes", arguments->attitudes, "Attitudes of a mesh that are taught")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--trials", arguments->trials, "Random scenes for each attitude")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option("--verified-views", arguments->verified_views,
                   "Nearest views that are verified; 1: the paper's way")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command->add_flag("--list", arguments->list, "Also list the objects, and what was not right");
  command->callback([arguments, action] { *action = [arguments] { return Run(*arguments); }; });
}

}  // namespace graspdb::client
