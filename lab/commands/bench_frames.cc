#include "lab/commands/bench_frames.h"

#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "client/cli/base/command.h"
#include "client/cli/base/splits.h"
#include "client/cli/recognize/scan_source.h"
#include "files/messages/pose_message.h"
#include "files/messages/scan_message.h"
#include "rendering/sample_parts.h"
#include "rendering/simulation.h"

namespace graspdb::lab {
namespace {

constexpr double kDepthUnitM = 0.001;

constexpr double kMegabyte = 1e6;

absl::StatusOr<std::vector<v1::RecognizeRequest>> ReadRequests(const BenchFrames& frames) {
  ASSIGN_OR_RETURN(client::ScanTasks scans, client::ListScans(frames.inputs, frames.split));
  const auto limit = static_cast<std::size_t>(frames.limit);
  if (limit > 0 && scans.tasks.size() > limit) scans.tasks.resize(limit);
  std::vector<v1::RecognizeRequest> out;
  for (const client::ScanTask& task : scans.tasks) {
    if (client::Interrupted()) return absl::CancelledError("interrupted before the first request");
    ASSIGN_OR_RETURN(v1::RecognizeRequest request, client::ReadScan(task));
    out.push_back(std::move(request));
  }
  return out;
}

absl::StatusOr<std::vector<v1::RecognizeRequest>> Simulate(const BenchFrames& frames) {
  SimulatedFrames simulated = frames.simulated;
  ASSIGN_OR_RETURN(simulated.camera, rendering::SimulatedCameraOf(frames.camera));
  if (frames.limit > 0) simulated.count = frames.limit;
  return SimulateRequests(simulated);
}

void AddSimulationOptions(CLI::App& command, BenchFrames* f) {
  CLI::Option* simulate = command.add_flag(
      "--simulate", f->simulate,
      "Send depth images of sample parts from a simulated Kinect instead of scans");
  command
      .add_option("--parts", f->simulated.parts,
                  "With --simulate: comma-separated ids of sample parts; default: all")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(rendering::SamplePartIds()))
      ->type_name("ID,...")
      ->needs(simulate);
  command.add_option("--camera", f->camera, "With --simulate: Kinect v1 (640x480) or v2 (512x424)")
      ->check(CLI::IsMember({"v1", "v2"}))
      ->capture_default_str()
      ->needs(simulate);
  command
      .add_option("--objects-per-scene", f->simulated.objects_per_scene,
                  "With --simulate: parts in a scene")
      ->check(CLI::Range(1, 8))
      ->capture_default_str()
      ->needs(simulate);
  command.add_option("--seed", f->simulated.seed, "With --simulate: seed of scenes and noise")
      ->capture_default_str()
      ->needs(simulate);
}

}  // namespace

absl::StatusOr<std::vector<v1::RecognizeRequest>> SimulateRequests(const SimulatedFrames& frames) {
  ASSIGN_OR_RETURN(const std::vector<rendering::Workpiece> parts,
                   rendering::SampleParts(frames.parts));
  rendering::RandomSceneOptions scenes;
  scenes.count = frames.count;
  scenes.objects_per_scene = frames.objects_per_scene;
  scenes.seed = frames.seed;
  ASSIGN_OR_RETURN(std::vector<rendering::PlannedCapture> plan,
                   rendering::PlanRandomScenes(parts, scenes));
  ASSIGN_OR_RETURN(rendering::DepthCamera camera, rendering::DepthCamera::Create(frames.camera));
  std::vector<v1::RecognizeRequest> out;
  for (const rendering::PlannedCapture& capture : plan) {
    ASSIGN_OR_RETURN(rendering::DepthFrame frame,
                     camera.Render(rendering::SceneOf(parts, capture, /*with_table=*/true),
                                   capture.world_sensor, capture.seed));
    v1::RecognizeRequest& request = out.emplace_back();
    *request.mutable_depth_image() = files::DepthMessage(rendering::ToCounts(frame, kDepthUnitM),
                                                         frames.camera.intrinsics, kDepthUnitM);
    *request.mutable_sensor_pose() = files::ToMessage(capture.world_sensor);
    *request.mutable_region_of_interest() = rendering::SimulatedRegion();
  }
  return out;
}

void AddFrameOptions(CLI::App& command, BenchFrames* f) {
  command.add_option("SCAN", f->inputs, "Point files (.pcd, .ply) or capture sets");
  client::AddSplitFlag(command, &f->split);
  AddSimulationOptions(command, f);
  command
      .add_option("--frames", f->limit,
                  "Number of frames to send in turn: the first scans (default: all), or simulated "
                  "scenes (default: 16); they are kept in memory")
      ->check(CLI::Range(1, 100'000))
      ->type_name("N");
  command.add_option("--cell", f->cell, "Cell whose calibration and settings apply");
  command.add_flag("--segmented", f->segmented,
                   "The scans contain only one object's points, no table");
  command
      .add_option_function<int>(
          "--verified-views", [f](int n) { f->pipeline.set_verified_view_count(n); },
          "Nearest views to verify; default: set by the server")
      ->check(CLI::Range(1, 100))
      ->type_name("K");
  command
      .add_option_function<double>(
          "--min-score", [f](double score) { f->pipeline.set_min_score(score); },
          "Minimum score; answers below it are UNKNOWN_OBJECT; default: set by the server")
      ->check(CLI::Range(0.0, 1.0))
      ->type_name("SCORE");
}

absl::StatusOr<std::vector<v1::RecognizeRequest>> MakeRequests(const BenchFrames& frames) {
  ASSIGN_OR_RETURN(std::vector<v1::RecognizeRequest> out,
                   frames.simulate ? Simulate(frames) : ReadRequests(frames));
  for (v1::RecognizeRequest& request : out) {
    if (!frames.cell.empty()) request.set_cell(client::ResourceName("cells", frames.cell));
    if (frames.segmented) request.set_segmented(true);
    *request.mutable_pipeline() = frames.pipeline;
  }
  return out;
}

std::string DescribeRequests(const std::vector<v1::RecognizeRequest>& requests) {
  double bytes = 0;
  for (const v1::RecognizeRequest& request : requests) {
    bytes += static_cast<double>(request.ByteSizeLong());
  }
  const double megabytes = bytes / kMegabyte / static_cast<double>(requests.size());
  const v1::RecognizeRequest& first = requests.front();
  if (!first.has_depth_image()) {
    return absl::StrFormat("%d clouds, %.2f MB each", requests.size(), megabytes);
  }
  const v1::CameraIntrinsics& camera = first.depth_image().intrinsics();
  return absl::StrFormat("%d depth images of %d x %d, %.2f MB each", requests.size(),
                         camera.width(), camera.height(), megabytes);
}

}  // namespace graspdb::lab
