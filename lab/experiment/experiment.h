// Runs a case: teaches, recognizes, judges.
#pragma once

#include <cstddef>
#include <map>
#include <vector>

#include "absl/status/statusor.h"
#include "lab/experiment/answer.h"
#include "lab/experiment/experiment_run.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/trials/cases.h"
#include "lab/experiment/trials/part_set.h"

namespace graspdb::lab {

struct CaseResult {
  ExperimentCase experiment;
  PartSet set;
  std::vector<Answer> answers = {};  // in the order of the queries
  // Visible points of the objects in some answers, by the answer's position; world frame, m.
  std::map<std::size_t, recognition::Points> scans = {};
};

// Errors as those of the trials, Gallery::Teach and Recognize. If `last` has the views of this
// case, nothing is taught again.
absl::StatusOr<CaseResult> RunCase(const ExperimentCase& experiment, const PartSet& set,
                                   const ExperimentTrials& trials, const ExperimentRun& run,
                                   LastGallery* last = nullptr);

// Shares and means over a case's answers.
struct CaseSummary {
  std::size_t known = 0;  // queries for taught objects; the shares are of these
  std::size_t posed = 0;  // those whose pose can be judged; shares of poses are of these
  double object_right = 0;
  double pose_right = 0;
  double strictly_right = 0;
  double ambiguous = 0;          // marked as ambiguous
  double listed = 0;             // only a further reading is right
  double mean_rotation_deg = 0;  // of right poses, modulo symmetry
  double mean_translation_mm = 0;
  double mean_ms = 0;
  std::size_t unknown = 0;      // queries for other objects
  double unknown_rejected = 0;  // share of these
};
CaseSummary Summarize(const CaseResult& result);

// Positions in `result.answers`, the worst first: wrong objects, then by the farthest point.
// Rejected unknown objects are left out, since there is nothing to show.
std::vector<std::size_t> WorstFirst(const CaseResult& result);

}  // namespace graspdb::lab
