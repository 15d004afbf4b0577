#include "lab/experiment/trials/close_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/random/counter_random.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector2d;
using recognition::Pose;

enum CloseSceneStream : std::uint64_t { kClosePlaces = 200, kCloseNoise };

constexpr int kFootprintPoints = 600;
constexpr int kTries = 60;
constexpr double kGapTolerance = 2e-4;

using Footprint = std::vector<Vector2d>;  // points of a shape, seen from above

Footprint FootprintOf(const rendering::Workpiece& part) {
  Footprint out;
  for (const Eigen::Vector3f& p :
       rendering::SampleSurface(part.mesh, kFootprintPoints, /*seed=*/1)) {
    out.push_back(p.head<2>().cast<double>());
  }
  return out;
}

Footprint Placed(const Footprint& footprint, double turn, const Vector2d& place) {
  const Eigen::Rotation2Dd rotation(turn);
  Footprint out;
  out.reserve(footprint.size());
  for (const Vector2d& p : footprint) out.push_back(rotation * p + place);
  return out;
}

double DistanceBetween(const Footprint& a, const Footprint& b) {
  double squared = 1e9;
  for (const Vector2d& p : a) {
    for (const Vector2d& q : b) squared = std::min(squared, (p - q).squaredNorm());
  }
  return std::sqrt(squared);
}

// A partial scene.
class CloseScene {
 public:
  CloseScene(const std::vector<Footprint>& footprints, const CloseSceneOptions& options,
             std::size_t number)
      : footprints_(footprints),
        options_(options),
        stream_(rendering::RandomBits(0, kClosePlaces, number)) {}

  // Puts a workpiece at the end of a walk towards the first one.
  void Put(std::size_t part) {
    const double turn = 2 * std::numbers::pi * Next();
    const double from = 2 * std::numbers::pi * Next();
    const Vector2d direction(std::cos(from), std::sin(from));
    const Footprint there = Placed(footprints_[part], turn, Vector2d::Zero());
    double walk = placed_.empty() ? 0 : 4 * rendering::kRegionHalfWidthM;
    while (!placed_.empty()) {
      double clear = 1e9;
      const Footprint here = Placed(there, 0, walk * direction);
      for (const Footprint& other : placed_) clear = std::min(clear, DistanceBetween(here, other));
      if (clear <= options_.gap_m + kGapTolerance) break;
      walk -= clear - options_.gap_m;  // no object is nearer than this on the way
    }
    placed_.push_back(Placed(there, 0, walk * direction));
    Pose pose = Pose::Identity();
    pose.rotate(Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()));
    pose.translation().head<2>() = walk * direction;
    placements_.push_back({.part = part, .world_object = pose});
  }

  // Moves the scene into the area; empty if it exceeds the region.
  std::optional<std::vector<rendering::Placement>> Finish() {
    Eigen::AlignedBox2d box;
    for (const Footprint& footprint : placed_) {
      for (const Vector2d& p : footprint) box.extend(p);
    }
    const Vector2d middle =
        options_.area_half_width_m * Vector2d(2 * Next() - 1, 2 * Next() - 1) - box.center();
    box.translate(middle);
    if (box.min().minCoeff() < -rendering::kRegionHalfWidthM ||
        box.max().maxCoeff() > rendering::kRegionHalfWidthM) {
      return std::nullopt;
    }
    for (rendering::Placement& p : placements_) p.world_object.translation().head<2>() += middle;
    return placements_;
  }

  double Next() { return rendering::RandomUniform(options_.seed, stream_, counter_++); }

  void Clear() {
    placed_.clear();
    placements_.clear();
  }

 private:
  const std::vector<Footprint>& footprints_;
  const CloseSceneOptions& options_;
  std::uint64_t stream_;
  std::uint64_t counter_ = 0;
  std::vector<Footprint> placed_;
  std::vector<rendering::Placement> placements_;
};

std::optional<std::vector<rendering::Placement>> PlaceClose(
    const std::vector<rendering::Workpiece>& parts, const std::vector<Footprint>& footprints,
    const CloseSceneOptions& options, std::size_t number) {
  CloseScene scene(footprints, options, number);
  for (int attempt = 0; attempt < kTries; ++attempt) {
    scene.Clear();
    std::vector<std::string> objects;
    std::size_t part = number % parts.size();
    for (int i = 0; i < options.objects_per_scene; ++i) {
      objects.push_back(parts[part].object_id);
      scene.Put(part);
      for (std::size_t k = 0; k < parts.size(); ++k) {
        part = static_cast<std::size_t>(scene.Next() * static_cast<double>(parts.size()));
        if (std::ranges::find(objects, parts[part].object_id) == objects.end()) break;
      }
    }
    if (auto placements = scene.Finish()) return placements;
  }
  return std::nullopt;
}

}  // namespace

absl::StatusOr<std::vector<rendering::PlannedCapture>> PlanCloseScenes(
    const std::vector<rendering::Workpiece>& parts, const CloseSceneOptions& options) {
  std::vector<Footprint> footprints;
  footprints.reserve(parts.size());
  for (const rendering::Workpiece& part : parts) footprints.push_back(FootprintOf(part));
  const Pose sensor =
      rendering::LookAt(Eigen::Vector3d::Zero(), options.stand.distances_m.front(),
                        options.stand.look_down_deg.front(), options.stand.azimuth_deg);
  std::vector<rendering::PlannedCapture> plan;
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.count); ++i) {
    auto placements = PlaceClose(parts, footprints, options, i);
    if (!placements) {
      return absl::FailedPreconditionError(
          absl::StrCat("scene ", i, " has no space for ", options.objects_per_scene, " of them"));
    }
    plan.push_back({.path = absl::StrFormat("clouds/close_%05d.pcd", i),
                    .split = v1::Capture::QUERY,
                    .placements = *std::move(placements),
                    .world_sensor = sensor,
                    .seed = rendering::RandomBits(options.seed, kCloseNoise, i)});
  }
  return plan;
}

}  // namespace graspdb::lab
