// The whole path: scan, segments, descriptors, nearest views, rough pose, refined
// pose, grasps.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/confidence.h"
#include "recognition/descriptor_index.h"
#include "recognition/grasp_proposals.h"
#include "recognition/parameters.h"
#include "recognition/registration.h"
#include "recognition/segmentation.h"
#include "recognition/stages.h"
#include "recognition/taught.h"

namespace graspdb::recognition {

// Everything that was taught, as of one revision. Immutable.
struct CatalogueSnapshot {
  std::int64_t revision = 0;
  DescriptorIndex index;
  // By resource name.
  std::shared_ptr<const std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>
      stable_poses;
};

// Why there is or is no answer; see the public contract.
enum class RecognitionOutcome {
  kOk,
  kEmptyRegion,
  kNoCluster,
  kUnknownObject,
  kAmbiguous,
  kIcpRejected,
  kNoGrasp,
  kOutOfWorkspace,
};

struct RecognitionParameters {
  SegmentationParameters segmentation;
  DescriptorParameters descriptor;
  MatchingParameters matching;
  std::optional<Box> workspace;  // world frame; where the tool may go
};

// A stored view that resembles the scan.
struct Candidate {
  std::shared_ptr<const TaughtView> view;
  double descriptor_distance = 0;
  std::optional<double> verification_score;  // where the view was aligned
};

// Another explanation of the same segment.
struct Alternative {
  std::shared_ptr<const TaughtView> view;
  Pose world_object = Pose::Identity();  // T_world_object
  double score = 0;                      // 0 to 1
};

// One thing on the table.
struct Detection {
  RecognitionOutcome outcome = RecognitionOutcome::kUnknownObject;
  std::shared_ptr<const TaughtView> view;  // null when unknown
  double score = 0;  // 0 to 1: confidence, or on the paper's way the share of matching points
  Pose rough_pose = Pose::Identity();    // T_world_object after the shift
  Pose refined_pose = Pose::Identity();  // T_world_object after the alignment
  // T_world_object of the same stable pose that explain the scan as well: the turns of a declared
  // symmetry (DeclaredTurns) or else those that were found, and others where the detection is
  // ambiguous.
  std::vector<Pose> equivalent_poses;
  // Something else explains the scan as well: another place, attitude or object.
  bool ambiguous = false;
  std::vector<Alternative> alternatives;  // that are not of the same stable pose
  bool touching = false;                  // the camera saw it and other things as one
  std::optional<Gate> rejected_by;        // of an object that is unknown
  Registration registration;
  std::shared_ptr<const SurfaceModel> model;  // that was aligned; null on the paper's way
  Evidence evidence;  // of the best explanation; all zero where models were not aligned
  Doubt doubt;
  std::vector<GraspProposal> grasps;  // best first
  std::vector<Candidate> candidates;  // nearest first
  std::size_t point_count = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world frame
};

struct Recognition {
  RecognitionOutcome outcome = RecognitionOutcome::kNoCluster;
  std::int64_t revision = 0;
  Pose world_sensor = Pose::Identity();
  WorldFrame world_frame = WorldFrame::kGiven;
  std::vector<Detection> detections;  // the nearest to the sensor first
  std::vector<StageReport> stages;
  // Views that were not looked at since further_view_budget was spent, and whether the search ended
  // early since search_ceiling_s had passed.
  std::size_t untried_view_count = 0;
  bool out_of_time = false;
};

// Recognises everything in a scan, on idle cores too. The same scan against the same snapshot gives
// the same answer. Errors as SegmentScan, and those of `clouds`. Thread-safe; `is_cancelled` is
// called from one thread at a time, not always the same.
absl::StatusOr<Recognition> Recognize(const Scan& scan, const CatalogueSnapshot& catalogue,
                                      ViewClouds& clouds, const RecognitionParameters& parameters,
                                      const IsCancelled& is_cancelled);

}  // namespace graspdb::recognition
