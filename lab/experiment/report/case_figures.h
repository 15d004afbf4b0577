// Figures of a case, object by object, and their tables for documents.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lab/experiment/descriptor_comparison.h"
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

// A case in the table of cases.
struct CaseRow {
  std::string name;
  CaseSummary summary;
  TimeFigures times;
};
CaseRow RowOf(const CaseResult& result);

// The cells of the table of cases, first the headings, as they are shown; units and per cent signs
// are in the headings. "–": the case has no such queries.
std::vector<std::vector<std::string>> CaseTable(const std::vector<CaseRow>& rows);

// The same of descriptors and distances: how often the nearest of the object's own views was taken
// from a side more than 15 degrees off, and how often the nearest of all is another object's.
std::vector<std::vector<std::string>> DescriptorTable(
    const std::vector<DescriptorFigures>& figures);

// A table with its headings as GitHub Markdown.
std::string TableMarkdown(const std::vector<std::vector<std::string>>& table);

}  // namespace graspdb::lab
