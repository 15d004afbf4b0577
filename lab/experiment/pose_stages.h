// Which step of a recognition loses the true pose of an object.
#pragma once

#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "lab/experiment/trials/part_set.h"
#include "recognition/base/pose_observer.h"

namespace graspdb::lab {

// A pose is right when its ADD-S is under this share of the diameter (Hinterstoisser et al. 2012).
inline constexpr double kFoundShare = 0.10;
// A pose that is still to be refined is near the true one under this share.
inline constexpr double kNearShare = 0.20;

// The steps in their order. A true pose that reached one has passed those before.
enum class PoseStage {
  kNone,
  kProposed,  // an initial pose is near it
  kKept,      // so is one of those that are refined
  kRefined,   // one that is left after the refinement is right
  kBest,      // so is the best one of its object there
  kAccepted,  // so is an answer
};
inline constexpr PoseStage kPoseStages[] = {PoseStage::kNone, PoseStage::kProposed,
                                            PoseStage::kKept, PoseStage::kRefined,
                                            PoseStage::kBest, PoseStage::kAccepted};

const char* TextOf(PoseStage stage);

// The next stage, which lost a pose that came as far as `stage`; not for kAccepted.
PoseStage After(PoseStage stage);

// Records the poses of some objects that a recognition goes through. Figures of it do not depend on
// the order in which its threads report them.
class PoseRecord {
 public:
  // Of the parts of these objects, by their ids. `set` must outlive the record.
  PoseRecord(const PartSet& set, const std::vector<std::string>& object_ids);

  // For MatchingParameters::observer. Must not outlive the record.
  recognition::PoseObserver Observer();

  // How far the object whose mesh is at `world_mesh` came by one source; kBest at most.
  PoseStage StageOf(const std::string& object_id, const recognition::Pose& world_mesh,
                    recognition::PoseSource source) const;

 private:
  struct PosedPart {
    std::size_t part = 0;  // position in the set
    recognition::Pose world_object;
  };
  struct Step {
    recognition::PoseStep step;
    recognition::PoseSource source;
    std::vector<PosedPart> poses;
  };

  const PartSet& set_;
  std::map<std::string, std::size_t, std::less<>> parts_;  // by resource name of the stable pose
  std::mutex mutex_;
  std::vector<Step> steps_;
};

// ADD-S of the part at `position` from where its mesh is, as a share of the diameter.
double ShareOff(const PartSet& set, std::size_t position, const recognition::Pose& world_object,
                const recognition::Pose& world_mesh);

}  // namespace graspdb::lab
