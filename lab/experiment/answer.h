// Answers of the recognition, judged.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/judge.h"
#include "lab/experiment/part_set.h"
#include "lab/experiment/trial.h"
#include "lab/experiment/true_pose.h"
#include "recognition/recognizer.h"

namespace graspdb::client {

// What came of a question about one object in a scene.
struct Answer {
  std::size_t part = 0;   // that was asked about
  std::size_t scene = 0;  // number of the question
  bool known = true;      // the part was taught
  bool posed = true;      // the answer's pose can be judged
  recognition::RecognitionOutcome outcome = recognition::RecognitionOutcome::kNoCluster;
  std::string stable_pose = {};  // that was answered, of the first reading; empty: none
  std::string view = {};         // taught view that the answer came from; empty: none
  // An object that is not known is right when no object is named.
  bool object_right = false;
  bool pose_right = false;
  bool strictly_right = false;
  // The answer said that it is ambiguous, and not its first reading but one of the further ones
  // that it lists is strictly right: it counts, with its error.
  bool listed = false;
  bool touching = false;  // the answer said that it touches something
  PoseError error = {};   // where the object is right
  double score = 0;
  recognition::Evidence evidence = {};
  std::size_t voxels = 0;
  recognition::ConfidenceFeatures features = {};  // of the answer, also of one that was rejected
  double milliseconds = 0;                        // for the whole scene
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor of the question
  // T_world_object. `found` is of the first reading; while that names another object, it
  // is in the frame of the stable pose answered.
  recognition::Pose truth = recognition::Pose::Identity();
  recognition::Pose found = recognition::Pose::Identity();
  std::vector<recognition::Candidate> candidates = {};  // nearest first
  // How the recognition judges the true pose; where wanted, of a known object whose pose is wrong.
  std::optional<TruePose> true_pose = {};
};

// Judges what `recognition` says of object number `which` of the trial: the detection nearest to
// what the camera sees of it.
Answer JudgeAnswer(const recognition::Recognition& recognition, const Trial& trial,
                   std::size_t which, const PartSet& set);

}  // namespace graspdb::client
