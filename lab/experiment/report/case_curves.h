// How a case's figures depend on a threshold, and what is taken for what.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "lab/experiment/experiment.h"

namespace graspdb::client {

using Curve = std::vector<std::pair<double, double>>;

// Recall, 0 to 1, over the ADD-S that is allowed as a share of the diameter, 0 to 0.1: questions
// about known objects whose object is right and whose pose is no farther off. Empty without any.
Curve RecallOverAddS(const CaseResult& result);

// Over the score below which an answer would be turned down, 0 to 1. Right: object and pose.
struct ScoreCurves {
  Curve precision;  // right ones among the answers that are left; ends where none is
  Curve recall;     // right ones among the questions about known objects
};
ScoreCurves OverScore(const CaseResult& result);

// Answers with an object whose score is in [low, low + 0.1); the last bin holds 1 too.
struct ScoreBin {
  double low = 0;
  std::size_t count = 0;
  double right = 0;  // share of them whose object and pose are right
};
std::vector<ScoreBin> ReliabilityBins(const CaseResult& result);  // ten of them

// How often which object was asked about and which one was answered; empty: none.
using Confusions = std::map<std::pair<std::string, std::string>, std::size_t>;
Confusions ConfusionsOf(const CaseResult& result);

}  // namespace graspdb::client
