#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "base/status_macros.h"
#include "client/cli/base/progress_line.h"
#include "client/cli/objects/taught_report.h"
#include "client/cli/teach/commands.h"
#include "client/cli/teach/guided_teach.h"
#include "client/cli/teach/stable_pose_report.h"
#include "client/teaching/mesh/cad_part.h"
#include "client/teaching/upload/cad_views.h"
#include "files/capture_sets/capture_check.h"
#include "rendering/mesh_part.h"
#include "rendering/meshes/length_unit.h"
#include "rendering/meshes/outward_faces.h"

namespace graspdb::client {
namespace {

// The options of guided teaching, some of which apply to a mesh, too, and those of a mesh.
struct TeachOptions : GuidedTeachOptions {
  std::string mesh;
  std::string unit;
  std::string camera = "v2";
  double look_down_deg = 40;
  double distance_m = 0.8;
  double min_probability = CadOptions{}.poses.min_probability;
  double stands_deg = CadOptions{}.poses.stands_rad * 180 / std::numbers::pi;
  double gripper_max_m = ParallelGripper{}.max_opening_m;
  std::vector<int> poses;
  std::string pictures;
  bool add = false;
  bool dry_run = false;
};

constexpr char kTeachFooter[] =
    R"(With a camera: guides you through the stable poses and the steps of a turntable, and
reports the capture quality of each view and the look-alikes. The cell defines the camera's
pose, its region the place of the turntable. Ctrl-D stops without losing views; run the same
command again to continue with the missing ones.

From a mesh: computes the stable poses of the object on the table, their probabilities, symmetries
and top grasps, and teaches simulated views of each. Existing stable poses keep their grasps. Run an
interrupted command again to continue it: no view is taught twice.

Examples:
  graspdb teach bracket --sensor freenect --cell press-3         # guided
  graspdb teach bracket --sensor freenect --cell press-3 --yes --settle 5   # motorised turntable
  graspdb teach bracket --mesh bracket.stl --unit mm --dry-run   # only print the stable poses
  graspdb teach bracket --mesh bracket.stl --unit mm --cell press-3
  graspdb teach bracket --mesh bracket.stl --unit mm --poses 1,3 --look-down 55 --distance 0.9)";

// A scan may have a few triangles that no turn makes consistent.
constexpr double kMaxOpposedShare = 0.005;

absl::StatusOr<CadPart> PartOf(const TeachOptions& options) {
  ASSIGN_OR_RETURN(
      const auto mesh,
      rendering::LoadPartMesh(options.mesh, rendering::MetresOf(options.unit).value_or(1)));
  if (const double opposed = rendering::OpposedShare(mesh); opposed > kMaxOpposedShare) {
    std::fprintf(stderr,
                 "graspdb: warning: of %.1f %% of the edges of %s both triangles turn against each "
                 "other, and its surface is open or has one side only, so its outside is not "
                 "known; turn its faces alike in the program that made it\n",
                 100 * opposed, options.mesh.c_str());
  }
  CadOptions cad;
  cad.poses = {.min_probability = options.min_probability,
               .stands_rad = options.stands_deg * std::numbers::pi / 180};
  cad.gripper.max_opening_m = options.gripper_max_m;
  const std::string& name = options.display_name.empty() ? options.object : options.display_name;
  absl::StatusOr<CadPart> part = ProposeCadPart(options.object, name, mesh, cad);
  if (!part.ok() || options.poses.empty()) return part;
  return Select(*part, options.poses);
}

absl::StatusOr<CadViews> ViewsOf(const TeachOptions& options, Client& client) {
  CadViews views;
  ASSIGN_OR_RETURN(views.camera, rendering::SimulatedCameraOf(options.camera));
  views.step_deg = options.step_deg;
  views.beside_others = options.add;
  views.world_sensor =
      rendering::LookAt(Eigen::Vector3d::Zero(), options.distance_m, options.look_down_deg, -90);
  if (options.cell.empty()) return views;
  ASSIGN_OR_RETURN(const auto cell, client.GetCell(ResourceName("cells", options.cell)));
  ASSIGN_OR_RETURN(views.world_sensor, StandOf(cell));
  return views;
}

// As a capture set declares it, for programs.
absl::Status PrintDeclaration(const CadPart& part) {
  v1::CapturedObject object;
  for (const rendering::Workpiece& workpiece : part.workpieces) {
    v1::CapturedObject one = rendering::DeclarationOf(workpiece);
    one.clear_mesh_path();
    object.MergeFrom(one);
  }
  return PrintJson(object);
}

absl::Status Report(const GlobalOptions& global, Client& client, const TeachOptions& options,
                    const UploadCounts& counts) {
  const absl::StatusOr<v1::CatalogStatus> status =
      ReportTaught(global, client, {.created = counts.created, .existing = counts.existing});
  if (!status.ok() || global.json || counts.created == 0) return status.status();
  return NoteLookAlikes(client, ResourceName("objects", options.object), *status);
}

absl::Status TeachByMesh(const GlobalOptions& global, const TeachOptions& options) {
  ASSIGN_OR_RETURN(const CadPart part, PartOf(options));
  if (!options.pictures.empty()) {
    RETURN_IF_ERROR(WriteStablePosePictures(part, options.pictures));
  }
  if (options.dry_run && global.json) return PrintDeclaration(part);
  if (!global.json) std::printf("%s", StablePoseTable(part).c_str());
  if (options.dry_run) return absl::OkStatus();
  Client client = Connect(global);
  ASSIGN_OR_RETURN(const CadViews views, ViewsOf(options, client));
  absl::StatusOr<UploadCounts> counts;
  {
    ProgressLine progress("views");
    const auto total = static_cast<int>(CountOf(part.workpieces, views));
    counts = TeachCadViews(
        client, part.workpieces, views,
        {.report = [&](std::size_t done) { progress.Report(static_cast<int>(done), total); },
         .cancelled = Interrupted});
  }
  if (!counts.ok()) return counts.status();
  return Report(global, client, options, *counts);
}

// Teaching does not change an object that exists.
void NoteKeptName(const GlobalOptions& global, const TeachOptions& options) {
  if (options.display_name.empty() || options.dry_run) return;
  const auto object = Connect(global).GetObject(ResourceName("objects", options.object));
  if (!object.ok() || object->display_name() == options.display_name) return;
  std::fprintf(stderr,
               "graspdb: %s exists and keeps its display name; change it with: graspdb objects set "
               "%s --display-name NAME\n",
               object->name().c_str(), options.object.c_str());
}

absl::Status Teach(const GlobalOptions& global, const TeachOptions& options) {
  absl::Status id = files::CheckId(options.object, "OBJECT");
  if (!id.ok()) return WrongUsage(id);
  absl::Status taught =
      options.mesh.empty() ? RunGuidedTeach(global, options) : TeachByMesh(global, options);
  if (taught.ok()) NoteKeptName(global, options);
  return taught;
}

// The options of which one selects how to teach.
struct Ways {
  CLI::Option* mesh = nullptr;
  CLI::Option* sensor = nullptr;
};

Ways AddWays(CLI::App& command, TeachOptions& o) {
  Ways ways;
  CLI::Option_group* way = command.add_option_group("way", "Source of the views");
  ways.mesh = way->add_option("--mesh", o.mesh, "The object's mesh (STL, PLY, OBJ)")
                  ->check(CLI::ExistingFile);
  ways.sensor = way->add_option("--sensor", o.sensor,
                                "The depth camera that views it, e.g. freenect; see "
                                "`graspdb sensors list`");
  way->require_option(1);
  return ways;
}

void AddMeshOptions(CLI::App& command, CLI::Option* mesh, TeachOptions& o) {
  mesh->needs(command
                  .add_option("--unit", o.unit,
                              "Unit of the mesh, which files do not specify: mm, cm, m, inch")
                  ->needs(mesh)
                  ->check(CLI::IsMember(rendering::LengthUnitNames())));
  command
      .add_option(
          "--min-probability", o.min_probability,
          "Omit stable poses that a dropped object comes to rest in with a lower probability ...")
      ->needs(mesh)
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option(
          "--stands", o.stands_deg,
          "... unless the table must be tilted by at least this many degrees before they tip "
          "over, e.g. an upright bottle")
      ->needs(mesh)
      ->check(CLI::Range(0.0, 180.0))
      ->capture_default_str();
  command
      .add_option("--poses", o.poses,
                  "Teach only these stable poses, numbered as --dry-run lists them")
      ->needs(mesh)
      ->delimiter(',')
      ->type_name("N,...");
  command.add_option("--gripper-max", o.gripper_max_m, "Maximum opening of the gripper, m")
      ->needs(mesh)
      ->check(CLI::Range(0.005, 0.5))
      ->capture_default_str();
  command.add_option("--pictures", o.pictures, "Folder for a picture of each stable pose")
      ->needs(mesh)
      ->type_name("FOLDER");
  command
      .add_flag("--dry-run", o.dry_run,
                "Print the stable poses and teach nothing; needs no server. With --json in the "
                "format of a capture set")
      ->needs(mesh);
  command
      .add_flag("--add", o.add,
                "Add the views even if a stable pose has views of another mesh or camera")
      ->needs(mesh);
}

void AddViewOptions(CLI::App& command, CLI::Option* mesh, CLI::Option* cell, TeachOptions& o) {
  command
      .add_option("--camera", o.camera,
                  "v1 or v2: a Kinect with pixel noise only; kinect-v1, kinect-v2, realsense-d4xx, "
                  "carmine: with the holes, frayed edges and distortion of the real camera")
      ->needs(mesh)
      ->check(CLI::IsMember(rendering::SimulatedCameras()))
      ->capture_default_str();
  command
      .add_option("--look-down", o.look_down_deg, "Angle of the camera below the horizon, degrees")
      ->needs(mesh)
      ->excludes(cell)
      ->check(CLI::Range(0.0, 90.0))
      ->capture_default_str();
  command.add_option("--distance", o.distance_m, "Distance of the camera from the object, m")
      ->needs(mesh)
      ->excludes(cell)
      ->check(CLI::Range(0.1, 5.0))
      ->capture_default_str();
}

void AddGuidedOptions(CLI::App& command, CLI::Option* sensor, TeachOptions& o) {
  command
      .add_option(
          "--axis", o.axis,
          "Position of the turntable's axis in the world frame, m; default: the middle of the "
          "cell's region")
      ->needs(sensor)
      ->delimiter(',')
      ->expected(2)
      ->type_name("X,Y");
  command
      .add_option("--plate-height", o.plate_height_m,
                  "Height of the turntable's plate above the table, m")
      ->needs(sensor)
      ->check(CLI::Range(0.0, 0.5))
      ->capture_default_str();
  command
      .add_flag("--yes", o.unattended.yes,
                "Answer every prompt as Enter does: unattended, one stable pose")
      ->needs(sensor);
  command
      .add_option_function<double>(
          "--settle", [&o](double seconds) { o.unattended.settle = absl::Seconds(seconds); },
          "Wait this long before each view instead of for Enter, e.g. while a motor turns the "
          "table")
      ->needs(sensor)
      ->check(CLI::Range(0.0, 3600.0))
      ->type_name("SECONDS");
  command.add_flag("--clockwise", o.clockwise, "The turntable turns clockwise as seen from above")
      ->needs(sensor);
}

}  // namespace

void AddTeachCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* command =
      AddCommand(app, "teach", "Teach an object with a camera or from its CAD model");
  auto options = std::make_shared<TeachOptions>();
  command->add_option("OBJECT", options->object, "Id of the object, e.g. bracket")->required();
  const Ways ways = AddWays(*command, *options);
  CLI::Option* cell = command->add_option(
      "--cell", options->cell,
      "The cell with the camera; with --mesh it defines the angle and distance of the views");
  ways.sensor->needs(cell);
  command->add_option("--display-name", options->display_name, "Name for people, of a new object");
  command->add_option("--step", options->step_deg, "Turn between views, degrees")
      ->check(CLI::Range(1.0, 120.0))
      ->capture_default_str();
  AddMeshOptions(*command, ways.mesh, *options);
  AddViewOptions(*command, ways.mesh, cell, *options);
  AddGuidedOptions(*command, ways.sensor, *options);
  command->footer(kTeachFooter);
  command->callback([=, &global] { *action = [=, &global] { return Teach(global, *options); }; });
}

}  // namespace graspdb::client
