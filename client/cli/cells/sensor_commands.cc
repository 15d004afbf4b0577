#include <google/protobuf/struct.pb.h>
#include <spdlog/spdlog.h>

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "base/status_macros.h"
#include "client/cell/sensors/kinds/open_sensor.h"
#include "client/cell/sensors/kinect/fakenect_recording.h"
#include "client/cli/base/camera.h"
#include "client/cli/cells/commands.h"
#include "files/base/json_object.h"
#include "files/depth/depth_png.h"
#include "files/messages/scan_message.h"
#include "files/points/point_file.h"
#include "rendering/sample_parts.h"

namespace graspdb::client {
namespace {

constexpr char kGrabFooter[] =
    R"(Depth images are written as 16-bit PNG with intrinsics.json beside them, clouds as PCD: a
folder that the sensor "files:DIR" plays back. With --json each frame prints one line:
{"file", "sensor"}.

Examples:
  graspdb sensors grab freenect --out /tmp/look
  graspdb sensors grab simulated:seed=7 --frames 20 --out /tmp/scenes)";

constexpr char kFakenectFooter[] =
    R"(Records a simulated Kinect v1 over random scenes, one after the other, for programs that use
libfreenect; captures.json has the true objects and poses.

Example:
  graspdb sensors fakenect --out /tmp/kinect
  fakenect /tmp/kinect graspdb sensors grab freenect --out /tmp/look)";

struct GrabOptions {
  std::string spec;
  std::string out;
  int frames = 1;
  double wait_s = 10;
};

struct FakenectOptions {
  std::string out;
  std::vector<std::string> parts;
  int scenes = 5;
  int objects_per_scene = 1;
  double hold_s = 2;
  std::uint64_t seed = 1;
};

absl::Status List(const GlobalOptions& global) {
  const std::vector<SensorListing> listing = ListSensors();
  if (!global.json) {
    std::printf("%s", SensorsText(listing).c_str());
    return absl::OkStatus();
  }
  for (const SensorListing& kind : listing) {
    google::protobuf::Struct document;
    files::JsonObject object(&document);
    object.Set(files::Json("kind", kind.kind), files::Json("built", kind.is_built),
               files::Json("connected", kind.connected));
    if (!kind.trouble.empty()) object.Set(files::Json("trouble", kind.trouble));
    RETURN_IF_ERROR(PrintJson(document));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::string> Keep(const SensorFrame& frame, const std::filesystem::path& folder,
                                 int number) {
  const std::string stem = absl::StrFormat("%04d", number);
  if (const auto* image = std::get_if<v1::DepthImage>(&frame.scan)) {
    const files::DepthPngCamera camera = {.intrinsics = files::FromMessage(image->intrinsics()),
                                          .depth_unit_m = files::DepthUnit(*image)};
    RETURN_IF_ERROR(files::WriteIntrinsics(folder / files::kIntrinsicsFile, camera));
    RETURN_IF_ERROR(files::WriteDepthPng(folder / (stem + ".png"), *image));
    return stem + ".png";
  }
  const auto& cloud = std::get<v1::PointCloud>(frame.scan);
  ASSIGN_OR_RETURN(recognition::Points points, files::PointsFromMessage(cloud));
  const auto count = static_cast<int>(points.size());
  const int width = cloud.width() > 0 ? cloud.width() : count;
  RETURN_IF_ERROR(files::WritePcd(folder / (stem + ".pcd"), {.points = std::move(points),
                                                             .normals = {},
                                                             .width = width,
                                                             .height = count / width,
                                                             .sensor_pose = frame.world_sensor}));
  return stem + ".pcd";
}

// A camera that is being opened, or was moved, may deliver frames before the deadline.
absl::StatusOr<SensorFrame> WaitForFrame(DepthSensor& sensor, MonotonicTime deadline) {
  for (;;) {
    absl::StatusOr<SensorFrame> frame = sensor.Next(deadline);
    if (!absl::IsUnavailable(frame.status()) || sensor.HasEnded() ||
        MonotonicTime::Now() > deadline || Interrupted()) {
      return frame;
    }
    absl::SleepFor(absl::Milliseconds(100));
  }
}

absl::Status PrintKept(bool as_json, const std::string& file, const std::string& sensor) {
  if (!as_json) {
    std::printf("%s of %s\n", file.c_str(), sensor.c_str());
    return absl::OkStatus();
  }
  google::protobuf::Struct document;
  files::JsonObject(&document).Set(files::Json("file", file), files::Json("sensor", sensor));
  return PrintJson(document);
}

absl::Status Grab(const GlobalOptions& global, const GrabOptions& options) {
  spdlog::set_level(spdlog::level::err);  // errors are reported at the end
  const auto sensor = OpenSensor(options.spec, {});
  if (!sensor.ok()) return NotOpened(sensor.status());
  for (int i = 0; i < options.frames; ++i) {
    if (Interrupted()) {
      return absl::CancelledError(
          absl::StrCat("interrupted after ", i, " of ", options.frames, " frames"));
    }
    const auto frame = WaitForFrame(**sensor, MonotonicTime::Now() + absl::Seconds(options.wait_s));
    if (!frame.ok()) return NotOfServer(frame.status());
    ASSIGN_OR_RETURN(const std::string name, Keep(*frame, options.out, i));
    absl::Status printed =
        PrintKept(global.json, absl::StrCat(options.out, "/", name), (*sensor)->Name());
    if (!printed.ok() || !WriteOutput()) return printed;
  }
  return absl::OkStatus();
}

absl::Status WriteFakenect(const GlobalOptions& global, const FakenectOptions& options) {
  ASSIGN_OR_RETURN(const std::vector<rendering::Workpiece> parts,
                   rendering::SampleParts(options.parts));
  ASSIGN_OR_RETURN(const auto plan, rendering::PlanRandomScenes(
                                        parts, {.stand = {},
                                                .count = options.scenes,
                                                .objects_per_scene = options.objects_per_scene,
                                                .seed = options.seed}));
  RETURN_IF_ERROR(WriteSimulatedRecording(options.out, parts, plan, absl::Seconds(options.hold_s)));
  if (global.json) {
    google::protobuf::Struct document;
    files::JsonObject(&document).Set(files::Json("folder", options.out),
                                     files::Json("scenes", options.scenes),
                                     files::Json("hold_s", options.hold_s));
    return PrintJson(document);
  }
  std::printf("wrote %d scenes of %g s to %s; play them with: fakenect %s PROGRAM\n",
              options.scenes, options.hold_s, options.out.c_str(), options.out.c_str());
  return absl::OkStatus();
}

void AddGrab(CLI::App& sensors, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<GrabOptions>();
  CLI::App* grab = AddCommand(sensors, "grab", "Write frames of a sensor to files");
  grab->add_option("SENSOR", options->spec, "Name from `sensors list`, or files:PATH, simulated")
      ->required();
  grab->add_option("--out", options->out, "Folder to write to")->required()->type_name("DIR");
  grab->add_option("--frames", options->frames, "Number of frames")
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  grab->add_option("--wait", options->wait_s, "Seconds to wait for each frame")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  grab->footer(kGrabFooter);
  grab->callback([=, &global] { *action = [=, &global] { return Grab(global, *options); }; });
}

void AddFakenect(CLI::App& sensors, const GlobalOptions& global, Action* action) {
  auto options = std::make_shared<FakenectOptions>();
  CLI::App* record = AddCommand(sensors, "fakenect", "Write a recording that fakenect plays");
  record->add_option("--out", options->out, "Folder to write to")->required()->type_name("DIR");
  record->add_option("--parts", options->parts, "Sample parts to show, ids separated by commas")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember(rendering::SamplePartIds()))
      ->type_name("ID,...");
  record->add_option("--scenes", options->scenes, "Number of scenes")
      ->check(CLI::Range(1, 1000))
      ->capture_default_str();
  record->add_option("--objects-per-scene", options->objects_per_scene, "Objects in a scene")
      ->check(CLI::Range(1, 8))
      ->capture_default_str();
  record->add_option("--hold", options->hold_s, "Seconds per scene")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  record->add_option("--seed", options->seed, "Seed of the scenes and the noise")
      ->capture_default_str();
  record->footer(kFakenectFooter);
  record->callback(
      [=, &global] { *action = [=, &global] { return WriteFakenect(global, *options); }; });
}

}  // namespace

void AddSensorsCommand(CLI::App& app, const GlobalOptions& global, Action* action) {
  CLI::App* sensors =
      AddCommand(app, "sensors", "List depth cameras, grab frames and write recordings");
  sensors->require_subcommand(1);
  AddCommand(*sensors, "list", "List the built-in sensor kinds and the connected sensors")
      ->callback([=, &global] { *action = [&global] { return List(global); }; });
  AddGrab(*sensors, global, action);
  AddFakenect(*sensors, global, action);
}

}  // namespace graspdb::client
