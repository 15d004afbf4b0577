// The taught data, as the recognition needs them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/base/types.h"
#include "recognition/models/surface_model.h"
#include "recognition/pairs/pair_model.h"

namespace graspdb::recognition {

// Turns of a tool about the object's z axis that keep a grasp valid, rad.
struct FreeTurn {
  double min_rad = 0;
  double max_rad = 0;
};

// Outcomes of a grasp that robots reported.
struct PickCounts {
  std::int64_t picked = 0;
  std::int64_t missed = 0;
  std::int64_t slipped = 0;
  bool operator==(const PickCounts&) const = default;
};

struct TaughtGrasp {
  std::string id;
  Pose object_tcp = Pose::Identity();  // T_object_tcp
  double approach_distance_m = 0;
  double gripper_opening_m = 0;
  int priority = 0;  // the higher, the earlier
  double retreat_distance_m = 0;
  std::optional<FreeTurn> free_turn = {};
  PickCounts picks = {};
};

struct TaughtView {
  std::string name;                      // resource name
  std::string content;                   // digest: names may be used again, content not
  std::string object;                    // resource name
  std::string stable_pose;               // resource name
  Pose world_object = Pose::Identity();  // T_world_object of the capture
  Pose world_sensor = Pose::Identity();  // T_world_sensor of the capture
  // The teacher specified the object's pose: the frame is that of the stable pose's other views.
  bool shares_frame = false;
};

struct TaughtStablePose {
  std::string name;        // resource name
  int symmetry_order = 1;  // about the object's z axis; 0: any turn
  std::vector<TaughtGrasp> grasps;
  // Detections of it that score lower are unknown, 0 to 1; absent: MatchingParameters::min_score.
  std::optional<double> min_score = {};
  std::vector<std::shared_ptr<const TaughtView>> views = {};  // by name
  std::optional<Pose> object_mesh = {};  // T_object_mesh; absent: not taught from a mesh
};

// Whether both are fused into the same model: views of one stable pose that share a frame.
bool HaveSameModel(const TaughtView& a, const TaughtView& b);

// Maximum number of views fused into one model. A turntable's steps of 5 degrees from five heights
// are 360; more add less than the camera's noise, and each takes a millisecond or two.
inline constexpr std::size_t kMaxFusedViews = 400;

// The views of `stable_pose` that have the same model as `view`, one of them; at most
// kMaxFusedViews, evenly chosen by name.
std::vector<const TaughtView*> ViewsOfModel(const TaughtView& view,
                                            const TaughtStablePose& stable_pose);

using StablePoses = std::vector<std::shared_ptr<const TaughtStablePose>>;

// Provides the prepared clouds of views. Implementations are thread-safe.
class ViewClouds {
 public:
  virtual ~ViewClouds() = default;
  // The view's voxels and normals in the world frame of its capture.
  virtual absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView& view) = 0;
  // The model of the object in `view`, one of `stable_pose`, in its frame: all views fused that
  // share it. Null when there is none.
  virtual absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) = 0;
  // The surface of these stable poses of one object as one model, see MakePairModelOf. Null where
  // there is none, and where the implementation does not keep any.
  virtual absl::StatusOr<std::shared_ptr<const PairModel>> LoadPairModel(
      const StablePoses& /*stable_poses*/) {
    return nullptr;
  }
};

// The model that `view` is fused into, made from the clouds of its views. Null without points;
// errors of `clouds`.
absl::StatusOr<std::shared_ptr<const SurfaceModel>> FuseModel(const TaughtView& view,
                                                              const TaughtStablePose& stable_pose,
                                                              ViewClouds& clouds);

// All stable poses by resource name.
using TaughtPoses = std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>;

// The stable poses that one pair model shows: those that were taught from one object's mesh
// together, every other one alone. Sorted by name; without those that have no view.
std::vector<StablePoses> PairModelGroups(const TaughtPoses& stable_poses);

// The view whose model stands for a stable pose: the first whose frame others share, or else the
// first. Null without views.
const TaughtView* ModelView(const TaughtStablePose& stable_pose);

// The surfaces of stable poses that were taught from one mesh, in the frame of that mesh: together
// they show the object from all sides. A single stable pose may also have no mesh; its model is
// then in its own frame. Null without points; errors of `clouds`.
absl::StatusOr<std::shared_ptr<const PairModel>> MakePairModelOf(const StablePoses& stable_poses,
                                                                 ViewClouds& clouds);

}  // namespace graspdb::recognition
