// Drawings of answers, after figures 10 and 16 of the paper.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"

namespace graspdb::client {

// Answers that are drawn for a case.
inline constexpr std::size_t kDrawnAnswers = 8;

// Of the worst answers, as the camera sees them: the scan (where `result.scans` has it), points on
// the true and on the found model, and what was answered. Empty where there is nothing to draw.
std::string MatchDrawings(const CaseResult& result);

}  // namespace graspdb::client
