#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "lab/commands/commands.h"
#include "lab/commands/eval_run.h"
#include "lab/experiment/trials/cases.h"
#include "rendering/meshes/length_unit.h"

namespace graspdb::lab {
namespace {

bool IsPlain(char c) {
  return absl::ascii_isalnum(static_cast<unsigned char>(c)) ||
         std::string("-_./,:=+@%").find(c) != std::string::npos;
}

std::string Quoted(const std::string& word) {
  if (!word.empty() && std::ranges::all_of(word, IsPlain)) return word;
  return absl::StrCat("'", absl::StrReplaceAll(word, {{"'", "'\\''"}}), "'");
}

constexpr char kEvalDescription[] =
    "Measure the recognition rate on meshes with a simulated Kinect, on a capture set or on frames "
    "of real cameras.\n"
    "Each mesh is taught on a turntable in its most probable resting orientation and recognised in "
    "new scenes. Of a capture set, the TEACH captures are taught and the QUERY captures "
    "recognised; the options for cases, seeds and meshes do not apply. graspdb-bigbird makes a "
    "capture set of BigBIRD, which repeats the paper's experiment. Of a folder with "
    "frames of real cameras and frames.json, the meshes in that file are taught and the frames "
    "recognised; for each object that is not found, the step that lost it is printed, and a table "
    "of these. No server is needed.";

constexpr char kEvalFooter[] =
    "Right: ADD-S under 5 % of the diameter. Strictly right: no point farther off than 8 mm, or\n"
    "6 % of the diameter.\n"
    "Examples:\n"
    "  graspdb eval meshes/*.ply\n"
    "  graspdb eval meshes/*.ply --out report             # then open report/report.html\n"
    "  graspdb eval meshes/*.ply --case hidden-20,hidden-40 --trials 8 --list\n"
    "  graspdb eval meshes/*.ply --case real-carmine,real-carmine-hidden-20 --trials 2\n"
    "  graspdb eval my-frames                            # with frames.json\n"
    "  graspdb eval my-frames --composited 8             # with the same meshes rendered into "
    "them\n"
    "  graspdb eval my-captures --leave-one-out --descriptors --out report\n"
    "  graspdb-bigbird bigbird set && graspdb eval set --descriptors --verified-views 1 "
    "--min-score 0   # as the paper";

std::vector<std::string> CaseNames() {
  std::vector<std::string> names;
  for (const ExperimentCase& experiment : ExperimentCases()) names.push_back(experiment.name);
  return names;
}

void AddFolderOptions(CLI::App* command, EvalArguments* arguments) {
  command->add_flag("--leave-one-out", arguments->leave_one_out,
                    "Capture sets: recognise each TEACH capture without its own view, instead of "
                    "the QUERY captures");
}

void AddPipelineOptions(CLI::App* command, EvalArguments* arguments) {
  command
      ->add_option(
          "--min-score", arguments->matching.min_score,
          "Minimum score of accepted answers; with 0 only those that explain little of the "
          "scan are rejected")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--verified-views", arguments->matching.verified_view_count,
                   "Nearest views to verify; 1: the single-view baseline")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option(
          "--further-views", arguments->matching.further_view_count,
          "Total number of views to try when those do not explain an object; four times as "
          "many where sides of it are hidden")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->add_flag("--without-image", arguments->without_image,
                    "Do not judge the answers in the scan's image, and search nothing there: what "
                    "segments alone give");
  command->add_flag("--without-search", arguments->without_search,
                    "Do not search for objects that have no cluster of their own by point pairs; "
                    "faster where something unknown is in the scene");
}

}  // namespace

void AddEvalCommand(CLI::App& app, client::Action* action) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = client::AddCommand(app, "eval", kEvalDescription);
  command->footer(kEvalFooter);
  command
      ->add_option("inputs", arguments->inputs,
                   "Mesh files (PLY, OBJ, STL), or the folder of a capture set, of frames with "
                   "frames.json")
      ->required()
      ->check(CLI::ExistingPath);
  AddFolderOptions(command, arguments.get());
  command
      ->add_option("--case", arguments->cases,
                   "Cases to run; default: all but real-..., which have simulated "
                   "cameras with the errors of real ones")
      ->delimiter(',')
      ->check(CLI::IsMember(CaseNames()));
  command
      ->add_option("--objects", arguments->choices.main,
                   "Meshes of the main cases, by file name without extension; default: all that "
                   "are not round")
      ->delimiter(',');
  command
      ->add_option_function<std::string>(
          "--unit",
          [arguments](const std::string& unit) {
            arguments->unit_m = rendering::MetresOf(unit).value_or(1);
          },
          "Unit of the meshes: mm, cm, m or inch")
      ->check(CLI::IsMember(rendering::LengthUnitNames()))
      ->default_str("m");
  command->add_option("--unit-m", arguments->unit_m, "The same in metres, for other units")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command
      ->add_option("--min-length-m", arguments->choices.min_length_m,
                   "Minimum size of meshes in the case \"everything\"")
      ->capture_default_str();
  command
      ->add_option("--max-length-m", arguments->choices.max_length_m,
                   "Maximum size of meshes in the case \"everything\"")
      ->capture_default_str();
  command->add_option("--seed", arguments->seed, "Seed of scenes and noise")->capture_default_str();
  command
      ->add_option("--orientations", arguments->selection.orientations,
                   "Orientations of a mesh in the case \"everything\"")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--trials", arguments->trials, "Random scenes for each orientation")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option("--composited", arguments->composited,
                   "Frames of real cameras: render so many scenes of the meshes into each, and "
                   "recognise those instead")
      ->check(CLI::Range(0, 1000))
      ->capture_default_str();
  AddPipelineOptions(command, arguments.get());
  command->add_flag("--own-thresholds", arguments->own_thresholds,
                    "Apply to each stable pose the threshold that its taught views propose, like "
                    "graspdb objects thresholds; takes longer");
  command->add_flag("--descriptors", arguments->descriptors,
                    "Also compare descriptors and distances, without verification, on the case "
                    "\"paper\" or on the folder");
  command->add_flag("--list", arguments->list, "Also list the objects and the wrong answers");
  command->add_option(
      "--out", arguments->out,
      "Folder for a report: report.json, after every case, and from it at the end report.html, "
      "cases.md for documents and poses in the format of the BOP challenge (graspdb-eval-report "
      "makes them, also after an interruption). For frames of real cameras: report.json, stages.md "
      "with the steps that lost the true poses, such poses and a picture of each frame with its "
      "right, wrong and lost objects");
  command->callback([command, arguments, action] {
    arguments->command = CommandText(*command);
    *action = [arguments] { return RunEval(*arguments); };
  });
}

std::string CommandText(const CLI::App& command) {
  std::vector<std::string> words = {command.get_name()};
  for (const CLI::App* app = command.get_parent(); app != nullptr; app = app->get_parent()) {
    words.insert(words.begin(), app->get_name());
  }
  for (const CLI::Option* option : command.get_options()) {
    if (option->count() == 0) continue;
    if (option->get_positional()) {
      for (const std::string& result : option->results()) words.push_back(Quoted(result));
      continue;
    }
    words.push_back(option->get_name());
    const bool takes_value = option->get_items_expected_max() > 0;
    if (takes_value) words.push_back(Quoted(absl::StrJoin(option->results(), ",")));
  }
  return absl::StrJoin(words, " ");
}

}  // namespace graspdb::lab
