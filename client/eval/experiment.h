// Runs a case: teaches, asks, judges.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/eval/cases.h"
#include "client/eval/experiment_run.h"
#include "client/eval/gallery.h"
#include "client/eval/part_set.h"

namespace graspdb::client {

// What came of a question about one thing in a scene.
struct Answer {
  std::size_t part = 0;   // that was asked about
  std::size_t scene = 0;  // number of the question
  bool known = true;      // the part was taught
  recognition::RecognitionOutcome outcome = recognition::RecognitionOutcome::kNoCluster;
  std::string stable_pose = {};  // that was answered; empty: none
  std::string view = {};         // taught view that the answer came from; empty: none
  // A thing that is not known is right when no object is named.
  bool object_right = false;
  bool pose_right = false;
  bool strictly_right = false;
  bool by_equivalent = false;  // one of the further poses of an ambiguous answer was the right one
  PoseError error = {};        // where the object is right
  double score = 0;
  recognition::Doubt doubt = {};  // of the answer, also of one that was rejected
  double milliseconds = 0;        // for the whole scene
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor of the question
  // T_world_object. While another object is named, `found` is that of the stable pose answered.
  recognition::Pose truth = recognition::Pose::Identity();
  recognition::Pose found = recognition::Pose::Identity();
  std::vector<recognition::Candidate> candidates = {};  // nearest first
};

struct CaseResult {
  ExperimentCase experiment;
  PartSet set;
  std::vector<Answer> answers = {};  // in the order of the questions
  // What the camera saw of the things in some answers, by the answer's position; world frame, m.
  std::map<std::size_t, recognition::Points> scans = {};
};

absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment, const PartSet& set,
                                   const ExperimentRun& run);

// Shares and means over a case's answers.
struct CaseSummary {
  std::size_t known = 0;  // questions about things that were taught; the shares are of these
  double object_right = 0;
  double pose_right = 0;
  double strictly_right = 0;
  double ambiguous = 0;          // of those that were said to be
  double mean_rotation_deg = 0;  // of right poses, modulo symmetry
  double mean_translation_mm = 0;
  double mean_ms = 0;
  std::size_t unknown = 0;      // questions about others
  double unknown_rejected = 0;  // share of those
};
CaseSummary Summarize(const CaseResult& result);

}  // namespace graspdb::client
