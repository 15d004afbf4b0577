#include "lab/experiment/report/case_figures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_replace.h"
#include "absl/strings/str_split.h"
#include "lab/experiment/gallery.h"

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

double OverAtLeastOne(double sum, std::size_t count) {
  return sum / static_cast<double>(std::max<std::size_t>(1, count));
}

// `sorted` is not empty.
double Percentile(const std::vector<double>& sorted, double share) {
  const double rank = std::ceil(share * static_cast<double>(sorted.size()));
  return sorted[static_cast<std::size_t>(std::max(1.0, rank)) - 1];
}

void Count(const Answer& answer, ObjectFigures* of) {
  ++of->query_count;
  of->known = answer.known;
  of->falsely_named += !answer.object_right;
  of->pose_wrong += answer.known && answer.posed && !answer.pose_right;
  if (!answer.known || !answer.pose_right) return;
  ++of->right_poses;
  of->mean_rotation_deg += answer.error.rotation_rad * 180 / std::numbers::pi;
  of->mean_translation_mm += answer.error.translation_m * 1e3;
}

}  // namespace

std::string ObjectOf(const std::string& stable_pose) {
  const std::vector<std::string> segments = absl::StrSplit(stable_pose, '/');
  if (segments.size() != 4 || segments[0] != "objects") return "";
  return segments[1];
}

std::optional<std::size_t> PartOfFound(const Answer& answer, const PartSet& set) {
  if (answer.stable_pose.empty()) return std::nullopt;
  // While the object is right, the pose is in the frame of the stable pose of the query.
  if (answer.known && ObjectOf(answer.stable_pose) == set.parts[answer.part].object_id) {
    return answer.part;
  }
  const auto named = std::ranges::find(set.parts, answer.stable_pose, StablePoseName);
  if (named == set.parts.end()) return std::nullopt;
  return static_cast<std::size_t>(named - set.parts.begin());
}

std::vector<ObjectFigures> FiguresByObject(const CaseResult& result) {
  std::map<std::string, ObjectFigures> by_object;
  for (const Answer& a : result.answers) Count(a, &by_object[result.set.parts[a.part].object_id]);
  std::vector<ObjectFigures> out;
  for (auto& [object, figures] : by_object) {
    figures.object = object;
    figures.falsely_named = OverAtLeastOne(figures.falsely_named, figures.query_count);
    figures.pose_wrong = OverAtLeastOne(figures.pose_wrong, figures.query_count);
    figures.mean_rotation_deg = OverAtLeastOne(figures.mean_rotation_deg, figures.right_poses);
    figures.mean_translation_mm = OverAtLeastOne(figures.mean_translation_mm, figures.right_poses);
    out.push_back(figures);
  }
  return out;
}

TimeFigures TimesOf(const CaseResult& result) {
  std::map<std::size_t, double> by_scene;  // objects in one scene share its time
  for (const Answer& a : result.answers) by_scene[a.scene] = a.milliseconds;
  std::vector<double> ms;
  ms.reserve(by_scene.size());
  for (const auto& [scene, took] : by_scene) ms.push_back(took);
  if (ms.empty()) return {};
  std::ranges::sort(ms);
  return {.scenes = ms.size(),
          .mean_ms = OverAtLeastOne(std::accumulate(ms.begin(), ms.end(), 0.0), ms.size()),
          .median_ms = Percentile(ms, 0.5),
          .p95_ms = Percentile(ms, 0.95),
          .longest_ms = ms.back()};
}

CaseRow RowOf(const CaseResult& result) {
  return {.name = result.experiment.name, .summary = Summarize(result), .times = TimesOf(result)};
}

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
