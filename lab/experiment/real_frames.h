// Recognition of objects taught from meshes in frames of real cameras, and which of its steps loses
// the true pose of an object.
#pragma once

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/answer.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/trials/frames_file.h"
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

// Teaches the stable poses of each mesh in the frames, like `graspdb teach --mesh`.
class FramesCatalogue {
 public:
  // Errors as LoadPartMesh, ProposeCadPart and Gallery::Teach.
  static absl::StatusOr<std::unique_ptr<FramesCatalogue>> Teach(
      const std::vector<RealFrame>& frames, const ExperimentRun& run);

  const PartSet& set() const { return set_; }
  const std::vector<std::string>& object_ids() const { return object_ids_; }  // sorted
  Gallery& gallery() { return *gallery_; }
  const recognition::CatalogueSnapshot& snapshot() const { return snapshot_; }
  // Of the stable pose at `position` of set(), that the gallery fuses.
  const std::shared_ptr<const recognition::SurfaceModel>& ModelOf(std::size_t position) const {
    return models_[position];
  }

 private:
  PartSet set_;
  std::vector<std::string> object_ids_;
  std::unique_ptr<Gallery> gallery_;
  std::vector<std::shared_ptr<const recognition::SurfaceModel>> models_;
  recognition::CatalogueSnapshot snapshot_{
      .revision = 0, .index = recognition::DescriptorIndex(1), .stable_poses = {}};
};

// An accepted detection, compared to the ground truth of the frame.
struct FrameDetection {
  std::string object;
  double score = 0;
  std::optional<std::size_t> instance = {};  // whose pose is right
  // ADD-S from `instance`, or from the nearest one of that name, as a share of the diameter;
  // infinity if the frame has no pose of that name.
  double add_s_share = std::numeric_limits<double>::infinity();
  bool pose_unknown = false;  // the true pose is unknown
  bool again = false;         // another detection already has that instance
  recognition::Pose sensor_mesh = recognition::Pose::Identity();  // T_sensor_mesh as answered
  std::size_t voxels = 0;
  recognition::Evidence evidence = {};
  recognition::ConfidenceFeatures features = {};
  // Not an object of the frame, or at a wrong pose.
  bool IsWrong() const { return !instance && !pose_unknown; }
};

// The recognition's step that lost an instance, in their order.
enum class LostBy {
  kSegmentation,  // most of its segment is another object, or it has none
  kSearch,        // at the true pose it would explain more than the best hypothesis
  kRanking,       // another hypothesis explains the segment better
  kConfidence,    // the best hypothesis is right, and was rejected
};

const char* TextOf(LostBy lost_by);

// The result for an object of the frame with a known pose.
struct FrameInstance {
  FrameObject object;
  bool found = false;
  TruePose truth = {};
  // The best explanation of the detection nearest to it, accepted or not.
  std::string best_object = {};  // empty: none
  bool best_is_right = false;    // that finds it
  double best_explains = 0;      // Evidence::score
  double best_score = 0;
  int rank = 0;  // of the first of its views among the candidates; 0: not among them
  LostBy lost_by = LostBy::kConfidence;  // if it is not found
  // How far its true pose came; of the sources alone kBest at most.
  PoseStage by_segments = PoseStage::kNone;
  PoseStage in_image = PoseStage::kNone;
  PoseStage stage() const { return found ? PoseStage::kAccepted : std::max(by_segments, in_image); }
};

// A model to draw into the frame.
struct PosedModel {
  enum class Verdict { kRight, kWrong, kLost };  // kLost: the true pose of a missed object
  std::shared_ptr<const recognition::SurfaceModel> model;           // not null
  recognition::Pose sensor_object = recognition::Pose::Identity();  // T_sensor_object
  Verdict verdict = Verdict::kRight;
};

struct FrameResult {
  const RealFrame* frame = nullptr;
  std::string error = {};  // why there is no answer; empty: there is one
  double milliseconds = 0;
  std::size_t segments = 0;
  std::vector<recognition::StageReport> stages = {};
  std::vector<FrameInstance> instances = {};
  std::vector<FrameDetection> detections = {};
  std::vector<PosedModel> posed = {};
};

// The scan of a frame. Errors as ReadPointFile.
absl::StatusOr<recognition::Scan> ReadScan(const RealFrame& frame);

// Recognises `scan` and judges the answer by the poses in `frame`. Errors of the recognition are
// part of the result.
FrameResult RecognizeFrame(const RealFrame& frame, const recognition::Scan& scan,
                           const ExperimentRun& run, FramesCatalogue* catalogue);

}  // namespace graspdb::lab
