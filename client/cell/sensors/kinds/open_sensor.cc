#include "client/cell/sensors/kinds/open_sensor.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "base/status_macros.h"
#include "client/cell/sensors/files/file_sensor.h"
#include "client/cell/sensors/kinect/freenect_sensor.h"
#include "client/cell/sensors/kinect/kinect_v1_calibration.h"
#include "client/cell/sensors/openni/openni2_sensor.h"
#include "client/cell/sensors/push/push_sensor.h"
#include "client/cell/sensors/reconnecting_sensor.h"
#include "client/cell/sensors/sensor_spec.h"
#include "client/cell/sensors/simulated/simulated_sensor.h"
#include "client/cell/sensors/video/v4l2_sensor.h"
#include "files/depth/depth_png.h"
#include "rendering/sample_parts.h"
#include "rendering/scene_file.h"
#ifdef GRASPDB_WITH_ARAVIS
#include "client/cell/sensors/genicam/genicam_sensor.h"
#endif
#ifdef GRASPDB_WITH_FREENECT2
#include "client/cell/sensors/kinect/freenect2_sensor.h"
#endif

namespace graspdb::client {
namespace {

// The requested resolution of OpenNI cameras, if supported.
constexpr int kOpenNi2Width = 640;
constexpr int kOpenNi2Height = 480;
// Of an image from its exposure to its arrival, s.
constexpr double kMaxLatencyS = 60;

using OpenedSensor = absl::StatusOr<std::unique_ptr<DepthSensor>>;

// A camera that is reopened after a loss, with fresh frames only.
OpenedSensor KeepOpen(const std::string& name, const SensorSettings& settings,
                      const SensorFactory& open) {
  const SensorFactory open_fresh = [open, max_age = settings.max_age]() -> OpenedSensor {
    OpenedSensor sensor = open();
    if (!sensor.ok()) return sensor;
    return std::make_unique<FreshSensor>(*std::move(sensor), max_age);
  };
  return std::make_unique<ReconnectingSensor>(
      name, open_fresh,
      ReconnectSettings{.first_pause = settings.first_pause, .max_pause = settings.max_pause});
}

// The settings, with the intrinsics of the options if given.
SensorSettings WithIntrinsics(SensorOptions& options, int width, int height,
                              SensorSettings settings) {
  const auto intrinsics = options.Intrinsics(width, height);
  if (intrinsics) settings.intrinsics = intrinsics;
  return settings;
}

OpenedSensor OpenFiles(const SensorSpec& spec, const SensorSettings& settings) {
  SensorOptions options(spec);
  FilePlayback playback;
  playback.loop = options.Flag("loop");
  playback.rate_hz = options.Number("rate", 0, 0, 1000);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  auto sensor = FileSensor::Open(spec.target, playback);
  // INVALID_ARGUMENT is for the spec, not for the content of files.
  if (absl::IsInvalidArgument(sensor.status())) {
    return absl::FailedPreconditionError(sensor.status().message());
  }
  if (!sensor.ok()) return sensor.status();
  return std::make_unique<FreshSensor>(*std::move(sensor), settings.max_age);
}

OpenedSensor OpenSimulated(const SensorSpec& spec, const SensorSettings& settings) {
  SensorOptions options(spec);
  const auto parts = rendering::SampleParts(options.List("parts"));
  const std::string camera_name = options.Text("camera", "v2");
  rendering::RandomSceneOptions scenes;
  scenes.seed = options.Seed("seed", scenes.seed);
  scenes.objects_per_scene = options.Integer("objects-per-scene", 1, 1, 8);
  scenes.area_half_width_m =
      options.Number("area", scenes.area_half_width_m, 0, rendering::kRegionHalfWidthM);
  scenes.stand.look_down_deg = {options.Number("look-down", 40, 0, 90)};
  scenes.stand.distances_m = {options.Number("distance", 0.8, 0.1, 5)};
  const double noise = options.Number("noise", 1, 0, 10);
  const std::string scene = options.Text("scene", "");
  RETURN_IF_ERROR(options.Finish(spec.kind));
  if (!parts.ok()) return parts.status();
  ASSIGN_OR_RETURN(rendering::DepthCameraModel camera, rendering::SimulatedCameraOf(camera_name));
  if (settings.intrinsics) camera.intrinsics = *settings.intrinsics;
  camera.noise.scale = noise;
  const SceneSource source =
      scene.empty()
          ? RandomScenes(*parts, scenes)
          : SceneSource([scene, parts = *parts] { return rendering::ReadScene(scene, parts); });
  ASSIGN_OR_RETURN(auto sensor, SimulatedSensor::Create(camera, *parts, source));
  return std::make_unique<FreshSensor>(std::move(sensor), settings.max_age);
}

OpenedSensor OpenKinectV1(const SensorSpec& spec, const SensorSettings& given) {
  SensorOptions options(spec);
  const SensorSettings settings = WithIntrinsics(options, kKinectV1Width, kKinectV1Height, given);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  return KeepOpen(
      absl::StrCat("Kinect v1 (libfreenect) no. ", spec.target.empty() ? "0" : spec.target),
      settings, [which = spec.target, settings] { return OpenFreenect(which, settings); });
}

OpenedSensor OpenOpenNi2Kind(const SensorSpec& spec, const SensorSettings& given) {
  SensorOptions options(spec);
  const bool is_recording = absl::EndsWithIgnoreCase(spec.target, ".oni");
  const bool loop = is_recording && options.Flag("loop");
  const SensorSettings settings = WithIntrinsics(options, kOpenNi2Width, kOpenNi2Height, given);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  if (is_recording) {
    // A recording that has ended is not reopened like a camera.
    OpenedSensor sensor = OpenOpenNi2(spec.target, loop, settings);
    if (!sensor.ok()) return sensor;
    return std::make_unique<FreshSensor>(*std::move(sensor), settings.max_age);
  }
  return KeepOpen(
      absl::StrCat("OpenNI 2 camera ", spec.target), settings,
      [uri = spec.target, settings] { return OpenOpenNi2(uri, /*loop=*/false, settings); });
}

OpenedSensor OpenPush(const SensorSpec& spec, const SensorSettings& settings) {
  SensorOptions options(spec);
  const bool allow_remote = options.Flag("allow-remote");
  RETURN_IF_ERROR(options.Finish(spec.kind));
  ASSIGN_OR_RETURN(auto sensor, PushSensor::Listen(spec.target, allow_remote, settings));
  return std::make_unique<FreshSensor>(std::move(sensor), settings.max_age);
}

// The camera of the options: a file as files/depth/depth_png.h reads it, or fx, fy, cx and cy.
absl::Status ReadCamera(SensorOptions& options, V4l2Options& camera, SensorSettings& settings) {
  const std::string file = options.Text("intrinsics", "");
  settings = WithIntrinsics(options, 640, 480, settings);
  const double unit = options.Number("unit", 0, 1e-6, 0.1);
  if (unit > 0) camera.unit_m = unit;
  if (file.empty()) return absl::OkStatus();
  const auto read = files::ReadIntrinsics(file);
  // INVALID_ARGUMENT is for the spec, not for the content of files.
  if (!read.ok()) return absl::FailedPreconditionError(read.status().message());
  if (read->lens.is_distorted() || !read->invalid_counts.empty()) {
    return absl::FailedPreconditionError(absl::StrCat(
        file, " has a distortion or invalid counts; images of V4L2 are read as rectified ones"));
  }
  settings.intrinsics = read->intrinsics;
  if (!camera.unit_m) camera.unit_m = read->depth_unit_m;
  return absl::OkStatus();
}

OpenedSensor OpenV4l2Kind(const SensorSpec& spec, const SensorSettings& given) {
  SensorOptions options(spec);
  SensorSettings settings = given;
  V4l2Options camera;
  camera.latency = absl::Seconds(
      options.Number("latency", absl::ToDoubleSeconds(camera.latency), 0, kMaxLatencyS));
  const absl::Status read = ReadCamera(options, camera, settings);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  RETURN_IF_ERROR(read);
  if (spec.target.empty()) {
    return absl::InvalidArgumentError("the sensor v4l2 has no device; write v4l2:/dev/video2");
  }
  return KeepOpen(
      absl::StrCat("V4L2 camera ", spec.target), settings,
      [path = spec.target, camera, settings] { return OpenV4l2(path, camera, settings); });
}

OpenedSensor OpenKinectV2([[maybe_unused]] const SensorSpec& spec,
                          [[maybe_unused]] const SensorSettings& given) {
#ifdef GRASPDB_WITH_FREENECT2
  SensorOptions options(spec);
  const SensorSettings settings = WithIntrinsics(options, kKinectV2Width, kKinectV2Height, given);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  return KeepOpen(absl::StrCat("Kinect v2 (libfreenect2) ", spec.target), settings,
                  [serial = spec.target, settings] { return OpenFreenect2(serial, settings); });
#else
  return absl::UnimplementedError(
      "this program is built without libfreenect2; install that library (Debian 12 has no package "
      "of it, see docs/sensors.md) and build again");
#endif
}

OpenedSensor OpenGenicamKind([[maybe_unused]] const SensorSpec& spec,
                             [[maybe_unused]] const SensorSettings& given) {
#ifdef GRASPDB_WITH_ARAVIS
  SensorOptions options(spec);
  GenicamOptions camera;
  camera.pixel_format = options.Text("format", "");
  camera.latency = absl::Seconds(
      options.Number("latency", absl::ToDoubleSeconds(camera.latency), 0, kMaxLatencyS));
  // The size is that of the image, unless given.
  const SensorSettings settings = WithIntrinsics(options, 0, 0, given);
  RETURN_IF_ERROR(options.Finish(spec.kind));
  return KeepOpen(
      absl::StrCat("GenICam camera ", spec.target), settings,
      [id = spec.target, camera, settings] { return OpenGenicam(id, camera, settings); });
#else
  return absl::UnimplementedError(
      "this program is built without Aravis; install libaravis-dev, and build again");
#endif
}

#ifdef GRASPDB_WITH_ARAVIS
constexpr bool kHasAravis = true;
#else
constexpr bool kHasAravis = false;
#endif
#ifdef GRASPDB_WITH_FREENECT2
constexpr bool kHasFreenect2 = true;
#else
constexpr bool kHasFreenect2 = false;
#endif

using CameraIds = absl::StatusOr<std::vector<std::string>>;

struct Kind {
  const char* name;
  const char* what;
  bool is_built;
  const char* package;
  OpenedSensor (*open)(const SensorSpec&, const SensorSettings&);
  CameraIds (*list)();   // null: there is nothing to list
  const char* why_none;  // when nothing was found
};

CameraIds ListGenicamKind() {
#ifdef GRASPDB_WITH_ARAVIS
  return ListGenicam();
#else
  return std::vector<std::string>();
#endif
}

CameraIds ListKinectV2() {
#ifdef GRASPDB_WITH_FREENECT2
  return ListFreenect2();
#else
  return std::vector<std::string>();
#endif
}

constexpr Kind kKinds[] = {
    {"files", "point files and depth images of a folder", true, "", OpenFiles, nullptr, ""},
    {"simulated", "random scenes of sample parts", true, "", OpenSimulated, nullptr, ""},
    {"push", "frames that another program pushes, with the SDK of the camera", true, "", OpenPush,
     nullptr, ""},
    {"genicam", "3D cameras of GigE Vision and USB3 Vision", kHasAravis, "libaravis-dev",
     OpenGenicamKind, ListGenicamKind,
     "none answered: is the camera in the network of this machine, with an address of it, and does "
     "the firewall let UDP pass?"},
    {"v4l2", "depth cameras of Video4Linux, such as RealSense", true, "", OpenV4l2Kind, ListV4l2,
     ""},
    {"freenect", "Kinect v1", true, "libfreenect-dev", OpenKinectV1, ListFreenect,
     "none on a USB port: has it its own power supply?"},
    {"openni2", "cameras and recordings of OpenNI 2", true, "libopenni2-dev", OpenOpenNi2Kind,
     ListOpenNi2, "none of the drivers of OpenNI 2 found one"},
    {"freenect2", "Kinect v2", kHasFreenect2, "libfreenect2, not in Debian 12", OpenKinectV2,
     ListKinectV2, "none on a USB 3 port: has it its own power supply?"},
};

}  // namespace

absl::StatusOr<std::unique_ptr<DepthSensor>> OpenSensor(const std::string& text,
                                                        const SensorSettings& settings) {
  ASSIGN_OR_RETURN(const SensorSpec spec, ParseSensorSpec(text));
  std::vector<std::string> names;
  for (const Kind& kind : kKinds) {
    if (spec.kind == kind.name) return kind.open(spec, settings);
    names.push_back(kind.is_built
                        ? kind.name
                        : absl::StrCat(kind.name, " (not built; needs ", kind.package, ")"));
  }
  return absl::InvalidArgumentError(absl::StrCat("there is no kind of sensor \"", spec.kind,
                                                 "\"; there are ", absl::StrJoin(names, ", ")));
}

std::vector<SensorListing> ListSensors() {
  std::vector<SensorListing> listing;
  for (const Kind& kind : kKinds) {
    SensorListing& entry = listing.emplace_back();
    entry.kind = kind.name;
    entry.what = kind.what;
    entry.is_built = kind.is_built;
    entry.package = kind.package;
    if (!kind.is_built || kind.list == nullptr) continue;
    const CameraIds connected = kind.list();
    if (!connected.ok()) {
      entry.trouble = std::string(connected.status().message());
      continue;
    }
    if (connected->empty()) entry.trouble = kind.why_none;
    for (const std::string& camera : *connected) {
      entry.connected.push_back(absl::StrCat(kind.name, ":", camera));
    }
  }
  return listing;
}

std::string SensorsText(const std::vector<SensorListing>& listing) {
  std::string text;
  for (const SensorListing& kind : listing) {
    absl::StrAppend(&text, kind.kind, ": ", kind.what);
    if (!kind.is_built) absl::StrAppend(&text, "; not built, needs ", kind.package);
    absl::StrAppend(&text, "\n");
    for (const std::string& camera : kind.connected) absl::StrAppend(&text, "  ", camera, "\n");
    if (!kind.trouble.empty()) absl::StrAppend(&text, "  ", kind.trouble, "\n");
  }
  return text;
}

}  // namespace graspdb::client
