// Which objects were taken for which.
#pragma once

#include <string>

#include "lab/experiment/experiment.h"

namespace graspdb::client {

// Objects asked about against objects answered: a matrix, or, where more than 30 objects were asked
// about, the pairs that were confused, the most frequent first.
std::string ConfusionChapter(const CaseResult& result);

}  // namespace graspdb::client
