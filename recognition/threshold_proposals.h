// From which score on an answer is to be believed, as the taught views themselves say.
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
  int asked_views = 0;      // that were asked about, each while it was not taught
  int right_views = 0;      // of which the stable pose was named
  // Seven of eight of those score at least this; absent without any.
  std::optional<double> right_score;
  // The highest score of this stable pose for a view of another one, while that view was not
  // taught or its object was not, and that view; absent where it was named for none.
  std::optional<double> wrong_score;
  std::string wrong_view;
  std::optional<double> min_score;  // proposed; absent: what holds for all is right
};

// Half way between what wrongly and what rightly named objects score, where that is below `usual`;
// `usual` where nothing was named rightly or the wrong ones score more. Never so low that nine of
// ten answers with such a score are wrong. Never above `usual`: views show the object alone,
// without the table that denies a wrong answer in a frame.
double ThresholdBetween(std::optional<double> right, std::optional<double> wrong, double usual);

// Of `object`'s stable poses (resource name; empty: all), by name. Some views of every stable pose
// in the catalogue are asked about with `parameters`, without that view, without their object, or
// both, as `object` needs it. `report` hears before each how many are done; its error ends the
// work. Errors of `clouds`; CANCELLED.
using ThresholdProgress = std::function<absl::Status(std::size_t done, std::size_t count)>;
absl::StatusOr<std::vector<ThresholdProposal>> ProposeThresholds(
    const CatalogueSnapshot& catalogue, ViewClouds& clouds, const std::string& object,
    const RecognitionParameters& parameters, const IsCancelled& is_cancelled,
    const ThresholdProgress& report);

}  // namespace graspdb::recognition
