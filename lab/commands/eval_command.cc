#include "lab/commands/eval_command.h"

#include <memory>
#include <string>
#include <vector>

#include "lab/commands/command_text.h"
#include "lab/commands/eval_run.h"
#include "lab/experiment/cases.h"

namespace graspdb::client {
namespace {

constexpr char kEvalDescription[] =
    "Measure how often the answer is right, on meshes that a simulated Kinect sees, on a capture "
    "set, on BigBIRD or on frames of real cameras.\n"
    "Each mesh is taught on a turntable in the orientation in which it most often comes to rest, "
    "and "
    "asked about in new scenes. Of a capture set, the TEACH captures are taught and the QUERY "
    "captures asked about; options about cases, seeds and meshes do not touch it. Of a folder in "
    "BigBIRD's layout (OBJECT/calibration.h5 with clouds or depth maps), the paper's experiment is "
    "done again: every --teach-step-deg degrees a view is taught, the others are asked about. Of a "
    "folder with frames of real cameras and frames.json, the meshes that this names are taught and "
    "the frames asked; of what is not found, it prints which step lost it. No server is needed.";

constexpr char kEvalFooter[] =
    "Right: ADD-S under 5 % of the diameter. Strictly right: no point farther off than 8 mm, or\n"
    "6 % of the diameter.\n"
    "Examples:\n"
    "  graspdb eval meshes/*.ply\n"
    "  graspdb eval meshes/*.ply --out report             # then open report/report.html\n"
    "  graspdb eval meshes/*.ply --case hidden-20,hidden-40 --trials 8 --list\n"
    "  graspdb eval meshes/*.ply --case real-carmine,real-carmine-hidden-20 --trials 2\n"
    "  graspdb eval my-frames                            # with frames.json\n"
    "  graspdb eval my-captures --leave-one-out --descriptors --out report\n"
    "  graspdb eval bigbird --descriptors --verified-views 1 --min-score 0   # as the paper";

std::vector<std::string> CaseNames() {
  std::vector<std::string> names;
  for (const ExperimentCase& experiment : ExperimentCases()) names.push_back(experiment.name);
  return names;
}

void AddFolderOptions(CLI::App* command, EvalArguments* arguments) {
  command->add_flag("--leave-one-out", arguments->leave_one_out,
                    "Of a capture set: ask each TEACH capture while it is not taught, in place of "
                    "the QUERY captures");
  command
      ->add_option("--cameras", arguments->bigbird.cameras,
                   "Of BigBIRD: the cameras, NP1 to NP5, whose views are taught and asked about")
      ->delimiter(',')
      ->check(CLI::IsMember({"NP1", "NP2", "NP3", "NP4", "NP5"}))
      ->capture_default_str();
  command
      ->add_option("--teach-step-deg", arguments->bigbird.teach_step_deg,
                   "Of BigBIRD: turns between taught views")
      ->check(CLI::Range(1, 360))
      ->capture_default_str();
}

}  // namespace

void AddEvalCommand(CLI::App& app, std::function<absl::Status()>* action) {
  auto arguments = std::make_shared<EvalArguments>();
  CLI::App* command = app.add_subcommand("eval", kEvalDescription);
  command->footer(kEvalFooter);
  command
      ->add_option("inputs", arguments->inputs,
                   "Mesh files (PLY, OBJ, STL), or the folder of a capture set, of frames with "
                   "frames.json, of BigBIRD or of one of its objects")
      ->required()
      ->check(CLI::ExistingPath);
  AddFolderOptions(command, arguments.get());
  command
      ->add_option("--case", arguments->cases,
                   "Cases to run; without it all but real-..., which look through "
                   "simulated cameras with the errors of real ones")
      ->delimiter(',')
      ->check(CLI::IsMember(CaseNames()));
  command
      ->add_option("--objects", arguments->choices.main,
                   "Meshes of the main cases, by file name without ending; all that are not round "
                   "without it. Objects of BigBIRD, by folder; all without it")
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
      ->add_option("--orientations", arguments->selection.orientations,
                   "Orientations of a mesh in the case \"everything\"")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command->add_option("--trials", arguments->trials, "Random scenes for each orientation")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option("--min-score", arguments->matching.min_score,
                   "Answers that are less sure are rejected; 0 rejects none")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--verified-views", arguments->matching.verified_view_count,
                   "Nearest views that are verified; 1: the single-view baseline")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  command
      ->add_option("--further-views", arguments->matching.further_view_count,
                   "Views that are looked at in all where those do not explain an object")
      ->check(CLI::Range(0, 10000))
      ->capture_default_str();
  command->add_flag("--own-thresholds", arguments->own_thresholds,
                    "Hold each stable pose to the threshold that its taught views propose, as "
                    "graspdb objects thresholds does; takes longer");
  command->add_flag("--descriptors", arguments->descriptors,
                    "Also compare descriptors and distances, without verification, on the case "
                    "\"paper\" or on the folder");
  command->add_flag("--list", arguments->list, "Also list the objects, and what was not right");
  command->add_option(
      "--out", arguments->out,
      "Folder for a report: report.html to read, cases.md for documents, "
      "report.json and poses as the BOP challenge takes them for programs; written "
      "again after every case. Of frames of real cameras: report.json and a picture of "
      "each frame with its right, wrong and lost objects");
  command->callback([command, arguments, action] {
    arguments->command = CommandText(*command);
    *action = [arguments] { return RunEval(*arguments); };
  });
}

}  // namespace graspdb::client
