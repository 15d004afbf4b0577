// Turns in which the models of a search were tried.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <unordered_map>
#include <vector>

#include "recognition/matching/rough_pose.h"

namespace graspdb::recognition {

// Of views that show a model in turns less apart than this, as from other heights, one is tried.
// With 20 degrees, every other one of views that are taught every 15, two of 96 scenes with
// touching objects were lost.
inline constexpr double kTriedTurnRad = 14 * std::numbers::pi / 180;

class TriedTurns {
 public:
  // False for a view of a model that was added in nearly the same turn: a glance at either leads to
  // the same place.
  bool Add(const TaughtView& view, const SeenSegment& segment) {
    std::vector<double>& known = of_model_[view.shares_frame ? view.stable_pose : view.name];
    const double turn = TurnOf(view, segment);
    const auto is_near = [&](double other) {
      return std::abs(std::remainder(turn - other, 2 * std::numbers::pi)) < kTriedTurnRad;
    };
    if (std::ranges::any_of(known, is_near)) return false;
    known.push_back(turn);
    return true;
  }

 private:
  std::unordered_map<std::string, std::vector<double>> of_model_;
};

}  // namespace graspdb::recognition
