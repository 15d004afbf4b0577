// Score thresholds of stable poses, proposed from their taught views.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/recognizer.h"

namespace graspdb::recognition {

struct ThresholdProposal {
  std::string stable_pose;  // resource name
  int query_views = 0;      // recognised, each while it was left out of the catalogue
  int right_views = 0;      // with the right stable pose
  // Seven of eight of those score at least this; absent without any.
  std::optional<double> right_score;
  // The highest score of this stable pose for a view of another one, while that view or its object
  // was left out, and that view; absent where there is none.
  std::optional<double> wrong_score;
  std::string wrong_view;
  std::optional<double> min_score;  // proposed; absent: the usual one is right
};

// Half way between the scores of wrong and right answers, where that is below `usual`; `usual`
// where no answer is right or the wrong ones score more. Never so low that nine of ten answers with
// such a score are wrong. Never above `usual`: views show the object alone, without the table that
// contradicts a wrong answer in a frame.
double ThresholdBetween(std::optional<double> right, std::optional<double> wrong, double usual);

// Of `object`'s stable poses (resource name; empty: all), by name. Recognises some views of every
// stable pose in the catalogue with `parameters`, without that view, without their object, or both,
// as `object` needs it. Calls `report` before each with the number done; its error ends the work.
// Errors of `clouds`; CANCELLED.
using ThresholdProgress = std::function<absl::Status(std::size_t done, std::size_t count)>;
absl::StatusOr<std::vector<ThresholdProposal>> ProposeThresholds(
    const CatalogueSnapshot& catalogue, ViewClouds& clouds, const std::string& object,
    const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
    const ThresholdProgress& report);

}  // namespace graspdb::recognition
