// Scans of wrong answers.
#pragma once

#include <cstddef>
#include <vector>

#include "absl/status/status.h"
#include "lab/experiment/experiment.h"

namespace graspdb::lab {

// Positions in `result.answers`, the worst first: wrong objects, then by the farthest point.
// Rejected unknown objects are left out, since there is nothing to show.
std::vector<std::size_t> WorstFirst(const CaseResult& result);

// Fills `result->scans` for the `count` worst answers: the points above the table around the
// object, at most 500; all points of a segmented scan. Errors as those of `queries`.
absl::Status KeepScans(std::size_t count, const TrialSource& queries, CaseResult* result);

}  // namespace graspdb::lab
