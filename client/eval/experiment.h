// Runs a case: teaches, asks, judges.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "client/eval/cases.h"
#include "client/eval/gallery.h"
#include "client/eval/judge.h"

namespace graspdb::client {

// What came of a question.
struct Answer {
  std::size_t part = 0;  // that was asked about
  recognition::RecognitionOutcome outcome = recognition::RecognitionOutcome::kNoCluster;
  std::string stable_pose = {};  // that was answered; empty: none
  bool object_right = false;
  bool pose_right = false;
  bool strictly_right = false;
  PoseError error = {};  // where the object and its attitude are right
  double score = 0;
  double milliseconds = 0;
  recognition::Pose truth = recognition::Pose::Identity();
  recognition::Pose found = recognition::Pose::Identity();
};

struct CaseResult {
  std::string name;
  std::vector<Answer> answers = {};  // in the order of the questions
};

// Workers run questions side by side; the result does not depend on how many there are.
struct ExperimentRun {
  recognition::RecognitionParameters parameters;
  int workers = 2;
  std::function<void(const std::string& step, std::size_t done, std::size_t total)> report;
  std::function<bool()> cancelled;
};

absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment,
                                   const std::vector<Workpiece>& parts,
                                   const std::vector<MeasuredShape>& shapes,
                                   const ExperimentRun& run);

// Shares and means over a case's answers.
struct CaseSummary {
  double object_right = 0;
  double pose_right = 0;
  double strictly_right = 0;
  double mean_rotation_deg = 0;  // of right poses, modulo symmetry
  double mean_translation_mm = 0;
  double mean_ms = 0;
};
CaseSummary Summarize(const CaseResult& result);

}  // namespace graspdb::client
