// The nearest views of one answer, after figure 17 of the paper.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"

namespace graspdb::client {

// Descriptor distances and verification scores of the first ten candidates of the worst answer
// that has any, with the one that became the answer in a frame. Empty without candidates.
std::string MatchingScores(const CaseResult& result);

}  // namespace graspdb::client
