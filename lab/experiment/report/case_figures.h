// Figures of a case, object by object.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/experiment.h"

namespace graspdb::lab {

// The object of a stable pose's resource name: "cup" for "objects/cup/stablePoses/upright"; empty
// for any other text.
std::string ObjectOf(const std::string& stable_pose);

// Position of the part in whose frame `answer.found` is; none where no stable pose of `set` is
// named.
std::optional<std::size_t> PartOfFound(const Answer& answer, const PartSet& set);

// What came of the queries about one object.
struct ObjectFigures {
  std::string object;  // id
  bool known = true;   // it was taught
  std::size_t query_count = 0;
  // Shares of the queries, 0 to 1. Known: another object or none was named. Not known: any was.
  double falsely_named = 0;
  double pose_wrong = 0;  // known: these, and those with a wrong pose
  // Means over the right poses, modulo symmetry.
  std::size_t right_poses = 0;
  double mean_rotation_deg = 0;
  double mean_translation_mm = 0;
};

// By object id.
std::vector<ObjectFigures> FiguresByObject(const CaseResult& result);

// Time for a whole scene, milliseconds; all zero without scenes. Percentiles are of the nearest
// rank.
struct TimeFigures {
  std::size_t scenes = 0;
  double mean_ms = 0;
  double median_ms = 0;
  double p95_ms = 0;
  double longest_ms = 0;
};
TimeFigures TimesOf(const CaseResult& result);

}  // namespace graspdb::lab
