// Judged answers of the recognition, and its scores of the true pose: why it was not the answer.
#pragma once

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/trials/part_set.h"
#include "lab/experiment/trials/trial.h"
#include "recognition/recognizer.h"
#include "recognition/verification/confidence.h"
#include "rendering/pose_error.h"

namespace graspdb::lab {

// A pose refined against a segment.
struct PoseScore {
  recognition::Pose refined = recognition::Pose::Identity();  // T_world_object
  recognition::Evidence evidence;
  recognition::ConfidenceFeatures features;
  double confidence = 0;  // 0 to 1
};

struct TruePose {
  std::size_t own_points = 0;      // voxels of the segment that lie on it
  std::size_t segment_points = 0;  // voxels of the segment with most of them; 0: none
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // of its own, world frame, m
  PoseScore whole;                                     // against all of the segment
  double own_score = 0;                                // against its own points alone

  // Of the segment's voxels, 0 to 1.
  double own_share() const {
    return static_cast<double>(own_points) /
           static_cast<double>(std::max<std::size_t>(1, segment_points));
  }
};

// Evidence and confidence features of a pose as text.
std::string TextOf(const recognition::Evidence& evidence,
                   const recognition::ConfidenceFeatures& features);
std::string TextOf(const TruePose& truth);

// Scores `model` at `world_object` (T_world_object) in the segment with most of its points. O(n)
// look-ups for n points of the scan. Thread-safe.
TruePose ScoreTruth(const recognition::Scan& scan, const recognition::Segmentation& segmentation,
                    const recognition::SurfaceModel& model, const recognition::Pose& world_object,
                    const recognition::RecognitionParameters& parameters);

// Result of a query for one object in a scene.
struct Answer {
  std::size_t part = 0;   // the true part
  std::size_t scene = 0;  // number of the query
  bool known = true;      // the part was taught
  bool posed = true;      // the answer's pose can be judged
  recognition::RecognitionOutcome outcome = recognition::RecognitionOutcome::kNoCluster;
  std::string stable_pose = {};  // of the answer, first reading; empty: none
  std::string view = {};         // taught view of the answer; empty: none
  // For an unknown object, no detection is right.
  bool object_right = false;
  bool pose_right = false;
  bool strictly_right = false;
  // The answer is ambiguous, and one of its further readings, not the first, is strictly right: it
  // counts, with its error.
  bool listed = false;
  bool touching = false;            // the answer is flagged as touching
  rendering::PoseError error = {};  // if the object is right
  double score = 0;
  recognition::Evidence evidence = {};
  std::size_t voxels = 0;
  recognition::ConfidenceFeatures features = {};  // of the answer, also if rejected
  double milliseconds = 0;                        // for the whole scene
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor of the query
  // T_world_object. `found` is of the first reading; while that names another object, it
  // is in the frame of the stable pose answered.
  recognition::Pose truth = recognition::Pose::Identity();
  recognition::Pose found = recognition::Pose::Identity();
  std::vector<recognition::Candidate> candidates = {};  // nearest first
  // Scores of the true pose; optional, for a known object whose pose is wrong.
  std::optional<TruePose> true_pose = {};
  std::string file = {};  // source of the query; empty: none
};

// Whether the answer is not strictly right; without a pose to judge, whether its object is wrong.
bool IsWrong(const Answer& answer);

// Judges the answer of `recognition` for object number `which` of the trial: the detection nearest
// to its visible points.
Answer JudgeAnswer(const recognition::Recognition& recognition, const Trial& trial,
                   std::size_t which, const PartSet& set);

}  // namespace graspdb::lab
