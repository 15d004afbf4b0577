// Options and workers of an experiment.
#pragma once

#include <cstddef>
#include <functional>
#include <string>

#include "absl/status/status.h"
#include "recognition/recognizer.h"

namespace graspdb::lab {

// Workers run queries in parallel; the result does not depend on their number.
struct ExperimentRun {
  recognition::RecognitionParameters parameters;
  int workers = 2;
  // Each stable pose has the threshold that its taught views propose.
  bool own_thresholds = false;
  // Answers that are not strictly right have the scores of the true pose (Answer::true_pose).
  bool judge_truth = false;
  std::size_t kept_scans = 0;  // of the worst answers, for pictures; each is rendered once more
  std::function<void(const std::string& step, std::size_t done, std::size_t total)> report;
  std::function<bool()> cancelled;
};

// Calls `work` for 0 … count - 1 on the run's workers, in any order, and reports after each; the
// first error ends it. CANCELLED if the run is.
absl::Status ForEach(std::size_t count, const std::string& step, const ExperimentRun& run,
                     const std::function<absl::Status(std::size_t)>& work);

}  // namespace graspdb::lab
