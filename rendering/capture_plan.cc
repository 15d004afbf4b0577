#include "rendering/capture_plan.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "rendering/camera/depth_camera.h"
#include "rendering/random/counter_random.h"

namespace graspdb::rendering {
namespace {

using recognition::Pose;

// Independent random numbers.
enum PlanStream : std::uint64_t { kTurntableNoise, kSceneNoise, kNamedPlace, kOtherPlaces };

absl::Status Bad(const std::string& what) { return absl::InvalidArgumentError(what); }

absl::Status CheckParts(const std::vector<Workpiece>& parts) {
  if (parts.empty()) return Bad("there is nothing to capture; give a mesh or a sample part");
  std::set<std::string> ids;
  for (const Workpiece& part : parts) {
    if (!ids.insert(absl::StrCat(part.object_id, "/", part.stable_pose_id)).second) {
      return Bad(absl::StrCat("two workpieces are ", part.object_id, " in the stable pose ",
                              part.stable_pose_id, "; rename one"));
    }
  }
  return absl::OkStatus();
}

absl::Status CheckStand(const CameraStand& stand) {
  const auto good_angle = [](double deg) { return deg >= 0 && deg <= 90; };
  const auto good_distance = [](double m) { return m > 0 && std::isfinite(m); };
  if (stand.look_down_deg.empty() || stand.distances_m.empty()) {
    return Bad("the camera has no pose; give a look-down angle and a distance");
  }
  if (!std::all_of(stand.look_down_deg.begin(), stand.look_down_deg.end(), good_angle) ||
      !std::isfinite(stand.azimuth_deg)) {
    return Bad("a look-down angle is not between 0 and 90 degrees");
  }
  if (!std::all_of(stand.distances_m.begin(), stand.distances_m.end(), good_distance)) {
    return Bad("a distance of the camera is not positive; give metres");
  }
  return absl::OkStatus();
}

Pose SensorPose(const CameraStand& stand, double look_down_deg, double distance_m) {
  return LookAt(Eigen::Vector3d::Zero(), distance_m, look_down_deg, stand.azimuth_deg);
}

Pose OnTable(double x, double y, double turn_rad) {
  Pose pose = Pose::Identity();
  pose.translation() = Eigen::Vector3d(x, y, 0);
  pose.rotate(Eigen::AngleAxisd(turn_rad, Eigen::Vector3d::UnitZ()));
  return pose;
}

// Largest distance of a workpiece from its z axis.
double ReachOf(const Workpiece& part) {
  float reach = 0;
  for (const Eigen::Vector3f& v : part.mesh.vertices) reach = std::max(reach, v.head<2>().norm());
  return static_cast<double>(reach);
}

// Random poses on the table, uniform in position and azimuth.
class Dice {
 public:
  Dice(std::uint64_t seed, std::uint64_t stream) : seed_(seed), stream_(stream) {}

  Pose Throw(double half_width_m) {
    const double x = half_width_m * (2 * Next() - 1);
    const double y = half_width_m * (2 * Next() - 1);
    return OnTable(x, y, 2 * std::numbers::pi * Next());
  }

 private:
  double Next() { return RandomUniform(seed_, stream_, counter_++); }

  std::uint64_t seed_;
  std::uint64_t stream_;
  std::uint64_t counter_ = 0;
};

// A free place for another workpiece; empty when none is found.
std::optional<Placement> FindPlace(const std::vector<Workpiece>& parts, std::size_t part,
                                   const std::vector<Placement>& there, Dice& dice) {
  constexpr int kTries = 500;
  constexpr double kGapM = 0.01;
  const double reach = ReachOf(parts[part]);
  for (int i = 0; i < kTries && reach < kRegionHalfWidthM; ++i) {
    const Pose pose = dice.Throw(kRegionHalfWidthM - reach);
    const auto is_clear = [&](const Placement& other) {
      const double apart = (pose.translation() - other.world_object.translation()).norm();
      return apart >= reach + ReachOf(parts[other.part]) + kGapM;
    };
    if (std::all_of(there.begin(), there.end(), is_clear)) {
      return Placement{.part = part, .world_object = pose};
    }
  }
  return std::nullopt;
}

absl::StatusOr<std::vector<Placement>> PlaceObjects(const std::vector<Workpiece>& parts,
                                                    const RandomSceneOptions& options,
                                                    std::size_t scene) {
  // Every scene has its own random stream, so that the first n scenes do not depend on later ones.
  Dice named(options.seed, RandomBits(0, kNamedPlace, scene));
  Dice others(options.seed, RandomBits(0, kOtherPlaces, scene));
  std::vector<Placement> placements = {
      {.part = scene % parts.size(), .world_object = named.Throw(options.area_half_width_m)}};
  for (int i = 1; i < options.objects_per_scene; ++i) {
    const std::size_t part = (scene + static_cast<std::size_t>(i)) % parts.size();
    const std::optional<Placement> place = FindPlace(parts, part, placements, others);
    if (!place) {
      return absl::FailedPreconditionError(absl::StrCat("scene ", scene, " has no space for ",
                                                        options.objects_per_scene,
                                                        " objects; use fewer objects in a scene"));
    }
    placements.push_back(*place);
  }
  return placements;
}

}  // namespace

absl::Status CheckPlacements(const std::vector<Workpiece>& parts, const PlannedCapture& capture) {
  const auto is_there = [&](const Placement& p) { return p.part < parts.size(); };
  if (std::ranges::all_of(capture.placements, is_there)) return absl::OkStatus();
  return Bad(capture.path + " has unknown workpieces");
}

absl::StatusOr<std::vector<PlannedCapture>> PlanTurntable(const std::vector<Workpiece>& parts,
                                                          const TurntableOptions& options) {
  RETURN_IF_ERROR(CheckParts(parts));
  RETURN_IF_ERROR(CheckStand(options.stand));
  if (!(options.azimuth_step_deg >= 0.01 && options.azimuth_step_deg <= 360)) {
    return Bad("the step of the turntable is not between 0.01 and 360 degrees");
  }
  const auto steps = static_cast<int>(std::ceil(360 / options.azimuth_step_deg - 1e-9));
  std::vector<PlannedCapture> plan;
  std::map<std::string, int> numbers;  // captures of an object so far
  for (std::size_t part = 0; part < parts.size(); ++part) {
    int& number = numbers[parts[part].object_id];
    for (const double look_down_deg : options.stand.look_down_deg) {
      for (const double distance_m : options.stand.distances_m) {
        const Pose sensor = SensorPose(options.stand, look_down_deg, distance_m);
        for (int k = 0; k < steps; ++k) {
          const double turn_deg = k * options.azimuth_step_deg;
          const Pose object = OnTable(0, 0, turn_deg * std::numbers::pi / 180);
          plan.push_back(
              {.path = absl::StrFormat("clouds/%s_%04d.pcd", parts[part].object_id, number++),
               .split = options.split,
               .placements = {{.part = part, .world_object = object}},
               .world_sensor = sensor,
               .seed = RandomBits(options.seed, kTurntableNoise, plan.size())});
        }
      }
    }
  }
  return plan;
}

absl::StatusOr<std::vector<PlannedCapture>> PlanRandomScenes(const std::vector<Workpiece>& parts,
                                                             const RandomSceneOptions& options) {
  RETURN_IF_ERROR(CheckParts(parts));
  RETURN_IF_ERROR(CheckStand(options.stand));
  if (options.count < 1 || options.objects_per_scene < 1) {
    return Bad("a plan needs at least one scene with one object");
  }
  if (!(options.area_half_width_m >= 0 && options.area_half_width_m <= kRegionHalfWidthM)) {
    return Bad(absl::StrCat("the area is not between 0 and ", kRegionHalfWidthM, " m"));
  }
  const Pose sensor = SensorPose(options.stand, options.stand.look_down_deg.front(),
                                 options.stand.distances_m.front());
  std::vector<PlannedCapture> plan;
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.count); ++i) {
    ASSIGN_OR_RETURN(std::vector<Placement> placements, PlaceObjects(parts, options, i));
    const std::string& id = parts[placements.front().part].object_id;
    plan.push_back({.path = absl::StrFormat("clouds/scene_%05d_%s.pcd", i, id),
                    .split = options.split,
                    .placements = std::move(placements),
                    .world_sensor = sensor,
                    .seed = RandomBits(options.seed, kSceneNoise, i)});
  }
  return plan;
}

}  // namespace graspdb::rendering
