#include "rendering/scene_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "files/capture_sets/capture_set.h"
#include "files/messages/pose_message.h"
#include "rendering/random/counter_random.h"
#include "rendering/simulation.h"

namespace graspdb::rendering {
namespace {

absl::StatusOr<std::size_t> PartOf(const std::vector<Workpiece>& parts,
                                   const v1::Capture& capture) {
  const auto found = std::ranges::find_if(parts, [&](const Workpiece& part) {
    return part.object_id == capture.object_id() && part.stable_pose_id == capture.stable_pose_id();
  });
  if (found != parts.end()) return static_cast<std::size_t>(found - parts.begin());
  return absl::InvalidArgumentError(absl::StrCat("there is no workpiece ", capture.object_id(),
                                                 " in the stable pose ", capture.stable_pose_id()));
}

// A capture's path without its number in the scene: see WriteScenes.
std::string SceneNameOf(const v1::Capture& capture) {
  const std::string& path = capture.path();
  const std::size_t dash = path.rfind('-');
  if (dash == std::string::npos || dash + 1 == path.size() ||
      path.find_first_not_of("0123456789", dash + 1) != std::string::npos) {
    return path;
  }
  return path.substr(0, dash);
}

absl::Status CheckOneScene(const std::filesystem::path& folder, const v1::CaptureSet& set) {
  const auto is_other = [&](const v1::Capture& capture) {
    return SceneNameOf(capture) != SceneNameOf(set.captures(0));
  };
  if (std::ranges::none_of(set.captures(), is_other)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(folder.string(),
                   " contains more than one scene; write one, with captures named "
                   "NAME-1, NAME-2, ..."));
}

std::uint64_t SeedOf(const v1::CaptureSet& set) {
  std::uint64_t seed = 0;
  for (const v1::Capture& capture : set.captures()) {
    const v1::Pose& pose = capture.object_pose();
    for (const double number : {pose.position().x(), pose.position().y(), pose.orientation().z()}) {
      // Bounded, since larger values and NaN do not fit an integer.
      const double bounded = std::isnan(number) ? 0 : std::clamp(number, -1e9, 1e9);
      seed = MixBits(seed ^ static_cast<std::uint64_t>(static_cast<std::int64_t>(bounded * 1e9)));
    }
  }
  return seed;
}

}  // namespace

absl::Status WriteScenes(const std::filesystem::path& folder, const std::vector<Workpiece>& parts,
                         const std::vector<PlannedCapture>& scenes) {
  v1::CaptureSet set = DeclareParts(parts);
  for (const PlannedCapture& scene : scenes) {
    RETURN_IF_ERROR(CheckPlacements(parts, scene));
    for (std::size_t i = 0; i < scene.placements.size(); ++i) {
      v1::Capture& capture = *set.add_captures();
      capture = CaptureOf(parts, scene, scene.placements[i]);
      capture.set_path(absl::StrCat(scene.path, "-", i + 1));
    }
  }
  return files::SaveCaptureSet(folder, set);
}

absl::StatusOr<PlannedCapture> ReadScene(const std::filesystem::path& folder,
                                         const std::vector<Workpiece>& parts) {
  const absl::StatusOr<v1::CaptureSet> set = files::LoadCaptureSet(folder);
  if (absl::IsNotFound(set.status()) || absl::IsFailedPrecondition(set.status())) {
    return absl::UnavailableError(set.status().message());
  }
  if (!set.ok()) return set.status();
  RETURN_IF_ERROR(CheckOneScene(folder, *set));
  PlannedCapture out;
  out.path = folder.string();
  for (const v1::Capture& capture : set->captures()) {
    ASSIGN_OR_RETURN(const std::size_t part, PartOf(parts, capture));
    out.placements.push_back({part, files::FromMessage(capture.object_pose())});
    out.world_sensor = files::FromMessage(capture.sensor_pose());
  }
  out.seed = SeedOf(*set);
  return out;
}

}  // namespace graspdb::rendering
