#include "client/sensors/truth_file.h"

#include <google/protobuf/util/json_util.h>

#include <set>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "client/files/atomic_file.h"
#include "client/files/pose_message.h"
#include "client/simulation/simulation.h"

namespace graspdb::client {
namespace {

v1::CaptureSet Describe(const std::vector<Workpiece>& parts,
                        const std::vector<PlannedCapture>& scenes) {
  v1::CaptureSet set;
  *set.mutable_region_of_interest() = SimulatedRegion();
  std::set<std::size_t> declared;
  for (const PlannedCapture& scene : scenes) {
    for (const Placement& placement : scene.placements) {
      if (placement.part >= parts.size()) continue;
      const Workpiece& part = parts[placement.part];
      if (declared.insert(placement.part).second) *set.add_objects() = DeclarationOf(part);
      v1::Capture* capture = set.add_captures();
      capture->set_path(scene.path);
      capture->set_split(scene.split);
      capture->set_object_id(part.object_id);
      capture->set_stable_pose_id(part.stable_pose_id);
      *capture->mutable_object_pose() = ToMessage(placement.world_object);
      *capture->mutable_sensor_pose() = ToMessage(scene.world_sensor);
    }
  }
  return set;
}

}  // namespace

absl::Status WriteTruth(const std::filesystem::path& path, const std::vector<Workpiece>& parts,
                        const std::vector<PlannedCapture>& scenes) {
  std::string text;
  google::protobuf::util::JsonPrintOptions options;
  options.add_whitespace = true;
  const auto printed =
      google::protobuf::util::MessageToJsonString(Describe(parts, scenes), &text, options);
  if (!printed.ok()) {
    return absl::InternalError(absl::StrCat("the truth of a scene cannot be written as JSON: ",
                                            std::string(printed.message())));
  }
  return WriteFileAtomically(path, text, Durability::kProcessCrash);
}

SceneSource WithTruthFile(SceneSource scenes, std::vector<Workpiece> parts,
                          std::filesystem::path path) {
  return [scenes = std::move(scenes), parts = std::move(parts),
          path = std::move(path)]() -> absl::StatusOr<PlannedCapture> {
    absl::StatusOr<PlannedCapture> scene = scenes();
    if (!scene.ok()) return scene;
    if (absl::Status written = WriteTruth(path, parts, {*scene}); !written.ok()) return written;
    return scene;
  };
}

}  // namespace graspdb::client
