#include "tests/bench/frames.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <random>

#include "files/points/point_file.h"
#include "recognition/segmentation/region.h"
#include "rendering/sample_parts.h"
#include "tests/recognition/scenes/shared_data.h"

namespace graspdb::bench {
namespace {

using recognition::Pose;

constexpr double kDistanceM = 0.8;
constexpr double kLookDownDeg = 40;
constexpr double kCircleM = 0.17;  // of the circle of five objects

// The benchmarks require their frames.
template <typename T>
T OrDie(absl::StatusOr<T> value) {
  if (value.ok()) return *std::move(value);
  std::fprintf(stderr, "graspdb_bench: %s\n", value.status().ToString().c_str());
  std::exit(1);
}

Frame Render(const std::string& name, const rendering::DepthCameraModel& model,
             const rendering::Scene& scene) {
  const auto camera = OrDie(rendering::DepthCamera::Create(model));
  Frame out;
  out.name = name;
  out.camera = model.intrinsics;
  out.world_sensor = rendering::LookAt(Eigen::Vector3d::Zero(), kDistanceM, kLookDownDeg, -90);
  out.region = {Eigen::Vector3d(-0.3, -0.3, -0.02), Eigen::Vector3d(0.3, 0.3, 0.4)};
  out.objects = scene.objects.size();
  const auto image = OrDie(camera.Render(scene, out.world_sensor, /*seed=*/1));
  out.depth = rendering::ToCounts(image, kDepthUnitM);
  return out;
}

// A Kinect v2 with 4.7 times the pixels over the same angle.
rendering::DepthCameraModel Megapixel() {
  rendering::DepthCameraModel out = rendering::KinectV2();
  out.intrinsics = {
      .width = 1280, .height = 800, .fx = 913.75, .fy = 913.75, .cx = 639.5, .cy = 399.5};
  return out;
}

// The first sample parts, on a circle if there are several.
Frame RenderObjects(const std::string& name, const rendering::DepthCameraModel& model,
                    std::size_t objects) {
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  rendering::Scene scene;
  for (std::size_t i = 0; i < objects; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / 5;
    Pose pose = Pose::Identity();
    if (objects > 1)
      pose.translation() << kCircleM * std::cos(angle), kCircleM * std::sin(angle), 0;
    scene.objects.push_back({&parts[i].mesh, pose});
  }
  return Render(name, model, scene);
}

// The pose from the segmentation replaces a calibration, so that both programs have the same input.
std::optional<Frame> ReadFrame(const std::filesystem::path& path) {
  auto file = files::ReadPointFile(path);
  if (!file.ok()) return std::nullopt;
  Frame out;
  out.name = path.stem().string();
  recognition::Scan scan;
  scan.points = std::move(file->points);
  recognition::StageLog log;
  const auto found = recognition::SegmentScan(
      scan, {}, {}, [] { return false; }, &log);
  if (!found.ok()) return std::nullopt;
  out.world_sensor = found->world_sensor;
  out.region = recognition::DefaultRegion(out.world_sensor);
  out.objects = found->segments.size();
  out.points = std::move(scan.points);
  return out;
}

}  // namespace

recognition::Scan ScanOf(const Frame& frame) {
  recognition::Scan out;
  out.points = frame.points;
  if (!frame.depth.empty()) out.depth_image = {frame.depth, frame.camera, kDepthUnitM};
  out.world_sensor = frame.world_sensor;
  out.region = frame.region;
  return out;
}

const Frame& SimulatedFrame(const std::string& name) {
  static std::map<std::string, Frame> made;
  const auto found = made.find(name);
  if (found != made.end()) return found->second;
  const bool is_megapixel = name.starts_with("megapixel");
  const auto camera = is_megapixel                    ? Megapixel()
                      : name.starts_with("kinect-v1") ? rendering::KinectV1()
                                                      : rendering::KinectV2();
  return made[name] = RenderObjects(name, camera, name.ends_with("-five") ? 5 : 1);
}

bool HasRealFrames() { return testing::SharedData("mosd_tabletop").has_value(); }

const std::vector<Frame>& RealFrames() {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> out;
    const auto folder = testing::SharedData("mosd_tabletop");
    if (!folder) return out;
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(*folder)) {
      if (entry.path().extension() == ".pcd") paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    for (const auto& path : paths) {
      if (auto frame = ReadFrame(path)) out.push_back(*std::move(frame));
    }
    return out;
  }();
  return frames;
}

std::vector<const Frame*> PointersTo(const std::vector<Frame>& frames) {
  std::vector<const Frame*> out;
  out.reserve(frames.size());
  for (const Frame& frame : frames) out.push_back(&frame);
  return out;
}

const std::vector<Frame>& PartFrames() {
  static const std::vector<Frame> frames = [] {
    std::vector<Frame> out;
    std::mt19937_64 random(5);
    const auto within = [&](double most) {
      return most * (static_cast<double>(random() % 2001) / 1000 - 1);
    };
    for (int round = 0; round < 2; ++round) {
      for (const rendering::Workpiece& part : rendering::SampleParts()) {
        Pose pose = Pose::Identity();
        pose.translation() << within(0.1), within(0.1), 0;
        pose.rotate(Eigen::AngleAxisd(within(std::numbers::pi), Eigen::Vector3d::UnitZ()));
        out.push_back(FrameOf(part.object_id, rendering::KinectV2(), pose));
      }
    }
    return out;
  }();
  return frames;
}

Frame FrameOf(const std::string& part, const rendering::DepthCameraModel& camera,
              const Pose& world_object) {
  const std::vector<rendering::Workpiece> parts = rendering::SampleParts();
  const auto found = std::ranges::find(parts, part, &rendering::Workpiece::object_id);
  rendering::Scene scene;
  scene.objects.push_back({&found->mesh, world_object});
  return Render(part, camera, scene);
}

}  // namespace graspdb::bench
