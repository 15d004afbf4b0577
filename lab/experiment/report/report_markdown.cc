#include "lab/experiment/report/report_markdown.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"

namespace graspdb::lab {
namespace {

using Cells = std::vector<std::string>;

constexpr char kNothing[] = "–";

Cells CellsOf(const CaseRow& row) {
  const CaseSummary& s = row.summary;
  const auto percent = [](bool has_queries, double share) -> std::string {
    return has_queries ? absl::StrFormat("%.1f", 100 * share) : kNothing;
  };
  const auto error = [&](double value) -> std::string {
    return s.posed > 0 && s.pose_right > 0 ? absl::StrFormat("%.2f", value) : kNothing;
  };
  const auto time = [&](double ms) -> std::string {
    return row.times.scenes > 0 ? absl::StrFormat("%.0f", ms) : kNothing;
  };
  const bool known = s.known > 0;
  return {row.name,
          absl::StrCat(s.known + s.unknown),
          percent(known, s.object_right),
          percent(s.posed > 0, s.pose_right),
          percent(s.posed > 0, s.strictly_right),
          percent(known, s.ambiguous),
          percent(known, s.listed),
          error(s.mean_rotation_deg),
          error(s.mean_translation_mm),
          percent(s.unknown > 0, s.unknown_rejected),
          time(row.times.mean_ms),
          time(row.times.median_ms),
          time(row.times.p95_ms)};
}

std::string Line(Cells cells) {
  for (std::string& cell : cells) cell = absl::StrReplaceAll(cell, {{"|", "\\|"}, {"\n", " "}});
  return absl::StrCat("| ", absl::StrJoin(cells, " | "), " |\n");
}

// Each name once, in the order in which they first come.
template <typename Member>
std::vector<std::string> NamesIn(const std::vector<DescriptorFigures>& figures, Member member) {
  std::vector<std::string> names;
  for (const DescriptorFigures& f : figures) {
    if (std::ranges::find(names, f.*member) == names.end()) names.push_back(f.*member);
  }
  return names;
}

}  // namespace

std::vector<Cells> CaseTable(const std::vector<CaseRow>& rows) {
  std::vector<Cells> table = {{"case", "queries", "object %", "pose %", "strictly %", "ambiguous %",
                               "only listed %", "turn °", "shift mm", "unknown rejected %",
                               "mean ms", "median ms", "95th percentile ms"}};
  for (const CaseRow& row : rows) table.push_back(CellsOf(row));
  return table;
}

std::vector<Cells> DescriptorTable(const std::vector<DescriptorFigures>& figures) {
  const auto distances = NamesIn(figures, &DescriptorFigures::distance);
  std::vector<Cells> table = {{"turned over / another object %"}};
  table.front().insert(table.front().end(), distances.begin(), distances.end());
  for (const std::string& descriptor : NamesIn(figures, &DescriptorFigures::descriptor)) {
    Cells cells = {descriptor};
    for (const std::string& distance : distances) {
      const auto found = std::ranges::find_if(figures, [&](const DescriptorFigures& f) {
        return f.descriptor == descriptor && f.distance == distance;
      });
      cells.push_back(found == figures.end()
                          ? kNothing
                          : absl::StrFormat("%.2f / %.2f", 100 * MeanFalseRecognition(*found),
                                            100 * found->object_wrong));
    }
    table.push_back(std::move(cells));
  }
  return table;
}

std::string TableMarkdown(const std::vector<Cells>& table) {
  Cells rule(table.front().size(), "---:");
  rule.front() = "---";
  std::string out = Line(table.front());
  absl::StrAppend(&out, Line(rule));
  for (std::size_t i = 1; i < table.size(); ++i) absl::StrAppend(&out, Line(table[i]));
  return out;
}

}  // namespace graspdb::lab
