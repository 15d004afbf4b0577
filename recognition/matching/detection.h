// The detection in one segment.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "recognition/base/types.h"
#include "recognition/grasps/grasp_proposals.h"
#include "recognition/matching/registration.h"
#include "recognition/models/taught.h"
#include "recognition/verification/confidence.h"

namespace graspdb::recognition {

// Outcome of a recognition; see the public contract.
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

// One object on the table.
struct Detection {
  RecognitionOutcome outcome = RecognitionOutcome::kUnknownObject;
  std::shared_ptr<const TaughtView> view;  // null when unknown
  double score = 0;  // 0 to 1: confidence, or share of inliers in the single-view baseline
  Pose rough_pose = Pose::Identity();    // T_world_object after the shift
  Pose refined_pose = Pose::Identity();  // T_world_object after the alignment
  // T_world_object of the same stable pose that explain the scan as well: the turns of a declared
  // symmetry (DeclaredTurns) or else those that were found, and others where the detection is
  // ambiguous.
  std::vector<Pose> equivalent_poses;
  // Another place, orientation or object explains the scan as well.
  bool ambiguous = false;
  std::vector<Alternative> alternatives;  // that are not of the same stable pose
  bool touching = false;                  // the camera saw it and other objects as one cluster
  std::optional<Gate> rejected_by;        // for an unknown object
  Registration registration;
  std::shared_ptr<const SurfaceModel> model;  // that was aligned; null in the single-view baseline
  Evidence evidence;  // of the best explanation; all zero where models were not aligned
  ConfidenceFeatures features;
  std::vector<GraspProposal> grasps;  // best first
  std::vector<Candidate> candidates;  // nearest first
  std::size_t point_count = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // world frame
};

}  // namespace graspdb::recognition
