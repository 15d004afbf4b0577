#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "lab/commands/commands.h"
#include "rendering/mesh_part.h"
#include "rendering/meshes/length_unit.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"

namespace graspdb::lab {
namespace {

// Values of the options.
struct Arguments {
  std::vector<std::string> meshes;
  std::string unit = "m";
  std::vector<std::string> parts;
  bool list_parts = false;
  std::string out;
  bool overwrite = false;
  bool turntable = false;
  double step_deg = 15;
  int random = 0;
  double area_m = 0.10;
  int objects_per_scene = 1;
  std::vector<double> look_down_deg = {40};
  std::vector<double> distances_m = {0.8};
  std::string camera = "v2";
  double noise = 1;
  bool no_table = false;
  bool segmented = false;
  std::uint64_t seed = 1;
  std::string split;
};

constexpr char kSimulateDescription[] =
    "Take captures of workpieces with a simulated Kinect and write them as a capture set.\n"
    "Without a mesh the built-in sample parts are used. A mesh keeps its orientation: its lowest "
    "point is put on the table, the middle of its bounding box at the origin.";

constexpr char kSimulateFooter[] =
    "Examples:\n"
    "  graspdb simulate --out teach                           # turntable, all sample parts\n"
    "  graspdb simulate --out scenes --random 96              # the same parts, anywhere\n"
    "  graspdb simulate --out both --turntable --random 96    # both in one set\n"
    "  graspdb simulate bolt.stl --unit mm --out bolt --look-down 35,50\n"
    "Then: graspdb import teach, and graspdb recognize scenes.";

void ListParts() {
  for (const rendering::Workpiece& part : rendering::SampleParts()) {
    std::cout << part.object_id << "\t" << part.display_name << "\n";
  }
}

// The error of a mesh, which may be meant as one of --parts: CLI11 ends these at a space.
absl::Status MeshError(const absl::Status& status, const std::string& path,
                       const std::vector<std::string>& parts) {
  const std::vector<std::string> ids = rendering::SamplePartIds();
  if (!absl::IsNotFound(status) || std::ranges::find(ids, path) == ids.end()) return status;
  return absl::NotFoundError(absl::StrCat("there is no mesh ", path,
                                          ", which is the id of a sample part; separate ids by "
                                          "commas: --parts ",
                                          absl::StrJoin(parts, ","), parts.empty() ? "" : ",",
                                          path));
}

absl::StatusOr<std::vector<rendering::Workpiece>> PartsOf(const Arguments& arguments) {
  std::vector<rendering::Workpiece> parts;
  for (const std::string& path : arguments.meshes) {
    absl::StatusOr<rendering::Workpiece> part =
        rendering::WorkpieceFromMesh(path, rendering::MetresOf(arguments.unit).value_or(1));
    if (!part.ok()) return MeshError(part.status(), path, arguments.parts);
    parts.push_back(*std::move(part));
  }
  if (!arguments.meshes.empty() && arguments.parts.empty()) return parts;
  ASSIGN_OR_RETURN(std::vector<rendering::Workpiece> samples,
                   rendering::SampleParts(arguments.parts));
  std::ranges::move(samples, std::back_inserter(parts));
  return parts;
}

v1::Capture::Split SplitOf(const Arguments& arguments, v1::Capture::Split otherwise) {
  if (arguments.split.empty()) return otherwise;
  return arguments.split == "TEACH" ? v1::Capture::TEACH : v1::Capture::QUERY;
}

absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanOf(
    const Arguments& arguments, const std::vector<rendering::Workpiece>& parts) {
  rendering::CameraStand stand;
  stand.look_down_deg = arguments.look_down_deg;
  stand.distances_m = arguments.distances_m;
  std::vector<rendering::PlannedCapture> plan;
  if (arguments.turntable || arguments.random == 0) {
    ASSIGN_OR_RETURN(
        plan, rendering::PlanTurntable(parts, {.stand = stand,
                                               .azimuth_step_deg = arguments.step_deg,
                                               .split = SplitOf(arguments, v1::Capture::TEACH),
                                               .seed = arguments.seed}));
  }
  if (arguments.random > 0) {
    ASSIGN_OR_RETURN(
        std::vector<rendering::PlannedCapture> scenes,
        rendering::PlanRandomScenes(parts, {.stand = stand,
                                            .count = arguments.random,
                                            .area_half_width_m = arguments.area_m,
                                            .objects_per_scene = arguments.objects_per_scene,
                                            .split = SplitOf(arguments, v1::Capture::QUERY),
                                            .seed = arguments.seed}));
    std::move(scenes.begin(), scenes.end(), std::back_inserter(plan));
  }
  return plan;
}

absl::Status Run(const Arguments& arguments) {
  if (arguments.list_parts) {
    ListParts();
    return absl::OkStatus();
  }
  ASSIGN_OR_RETURN(std::vector<rendering::Workpiece> parts, PartsOf(arguments));
  ASSIGN_OR_RETURN(std::vector<rendering::PlannedCapture> plan, PlanOf(arguments, parts));
  rendering::SimulationOptions options;
  ASSIGN_OR_RETURN(options.camera, rendering::SimulatedCameraOf(arguments.camera));
  options.camera.noise.scale = arguments.noise;
  options.with_table = !arguments.no_table;
  options.segmented = arguments.segmented;
  options.overwrite = arguments.overwrite;
  {
    client::ProgressLine progress;
    const auto report = [&progress](int done, int total) { progress.Report(done, total); };
    const rendering::SimulationWatch watch = {.report = report, .cancelled = {}};
    RETURN_IF_ERROR(rendering::WriteSimulation(arguments.out, parts, plan, options, watch));
  }
  std::cout << "wrote " << plan.size() << " captures of " << parts.size() << " objects to "
            << arguments.out << "\n";
  return absl::OkStatus();
}

void AddObjectOptions(CLI::App& command, Arguments& a) {
  command.add_option("mesh", a.meshes, "Meshes to capture (PLY, OBJ, STL)")->type_name("MESH");
  command.add_option("--unit", a.unit, "Unit of the meshes: mm, cm, m or inch")
      ->check(CLI::IsMember(rendering::LengthUnitNames()))
      ->capture_default_str();
  command.add_option("--parts", a.parts, "Comma-separated ids of sample parts")
      ->delimiter(',')
      ->allow_extra_args(false)  // or it takes the meshes
      ->check(CLI::IsMember(rendering::SamplePartIds()))
      ->type_name("ID,...");
  command.add_flag("--list-parts", a.list_parts, "List the sample parts and exit");
  command.add_option("--out", a.out, "Folder to write the capture set to")->type_name("SET");
  command.add_flag("--overwrite", a.overwrite, "Replace an existing capture set");
}

void AddPlanOptions(CLI::App& command, Arguments& a) {
  command.add_flag("--turntable", a.turntable,
                   "Turn every object about its z axis, split TEACH (default without --random)");
  command.add_option("--step", a.step_deg, "Turn between captures, degrees")
      ->check(CLI::Range(0.1, 360.0))
      ->capture_default_str();
  command.add_option("--random", a.random, "Number of random scenes to take, split QUERY")
      ->check(CLI::Range(1, 1'000'000))
      ->type_name("N");
  command
      .add_option("--area", a.area_m, "Random objects lie up to this from the origin in x, y; m")
      ->check(CLI::Range(0.0, rendering::kRegionHalfWidthM))
      ->capture_default_str();
  command.add_option("--objects-per-scene", a.objects_per_scene, "Objects in a random scene")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  command.add_option("--split", a.split, "Write all captures as TEACH or QUERY")
      ->check(CLI::IsMember({"TEACH", "QUERY"}));
  command.add_option("--seed", a.seed, "Seed of scenes and noise")->capture_default_str();
}

void AddCameraOptions(CLI::App& command, Arguments& a) {
  command
      .add_option("--camera", a.camera,
                  "v1 or v2: a Kinect with per-pixel noise only; kinect-v1, kinect-v2, "
                  "realsense-d4xx, carmine: with holes, frayed edges and warps of a real one")
      ->check(CLI::IsMember(rendering::SimulatedCameras()))
      ->capture_default_str();
  command
      .add_option("--look-down", a.look_down_deg,
                  "Angles of the camera below the horizon, degrees; random scenes use the first")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(0.0, 90.0))
      ->type_name("DEG,...")
      ->capture_default_str();
  command
      .add_option("--distance", a.distances_m,
                  "Distances of the camera from the origin, m; random scenes use the first")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::Range(0.1, 5.0))
      ->type_name("M,...")
      ->capture_default_str();
  command.add_option("--noise", a.noise, "Factor on the camera's noise; 0 is an ideal camera")
      ->check(CLI::Range(0.0, 10.0))
      ->capture_default_str();
  command.add_flag("--no-table", a.no_table, "Leave out the table");
  command.add_flag("--segmented", a.segmented, "Write only the object's points");
}

}  // namespace

void AddSimulateCommand(CLI::App& app, client::Action* action) {
  const auto arguments = std::make_shared<Arguments>();
  CLI::App* command = client::AddCommand(app, "simulate", kSimulateDescription);
  command->footer(kSimulateFooter);
  AddObjectOptions(*command, *arguments);
  AddPlanOptions(*command, *arguments);
  AddCameraOptions(*command, *arguments);
  command->callback([arguments, action] {
    if (arguments->out.empty() && !arguments->list_parts) throw CLI::RequiredError("--out");
    *action = [arguments] { return Run(*arguments); };
  });
}

}  // namespace graspdb::lab
