#include "lab/experiment/report/case_section.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "lab/experiment/report/case_curves.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/confusion_chapter.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/match_drawing.h"
#include "lab/experiment/report/matching_scores.h"
#include "lab/experiment/report/plot.h"
#include "lab/experiment/report/settings_text.h"

namespace graspdb::client {
namespace {

std::string Figure(const std::string& plot) {
  return absl::StrCat("<figure>", plot, "</figure>\n");
}

std::string Chapter(const std::string& heading, const std::string& words) {
  return absl::StrCat("<h3>", EscapeMarkup(heading), "</h3>\n<p>", EscapeMarkup(words), "</p>\n");
}

// Figure 12 of the paper.
std::string FalseRecognition(const std::vector<ObjectFigures>& figures) {
  BarChart known{.title = "False recognition for each object",
                 .unit = " %",
                 .categories = {},
                 .series = {{"object wrong or none", {}}, {"object or pose wrong", {}}},
                 .scale_end = 100};
  BarChart unknown{.title = "Named although it was not taught",
                   .unit = " %",
                   .categories = {},
                   .series = {{"named", {}}},
                   .scale_end = 100};
  for (const ObjectFigures& f : figures) {
    BarChart& chart = f.known ? known : unknown;
    chart.categories.push_back(f.object);
    chart.series[0].values.push_back(100 * f.falsely_named);
    if (f.known) chart.series[1].values.push_back(100 * f.pose_wrong);
  }
  std::string out = Chapter("False recognition", "Share of the questions about each object.");
  for (const BarChart& chart : {known, unknown}) {
    if (!chart.categories.empty()) absl::StrAppend(&out, Figure(DrawBars(chart)));
  }
  return out;
}

// Figure 13 of the paper.
std::string PoseErrors(const std::vector<ObjectFigures>& figures) {
  BarChart turn{.title = "Mean absolute rotation error for each object",
                .unit = "°",
                .categories = {},
                .series = {{"rotation", {}}}};
  BarChart shift{.title = "Mean absolute translation error for each object",
                 .unit = " mm",
                 .categories = {},
                 .series = {{"translation", {}}}};
  for (const ObjectFigures& f : figures) {
    if (!f.known) continue;
    turn.categories.push_back(f.object);
    shift.categories.push_back(f.object);
    turn.series[0].values.push_back(f.right_poses > 0 ? f.mean_rotation_deg : kNoBar);
    shift.series[0].values.push_back(f.right_poses > 0 ? f.mean_translation_mm : kNoBar);
  }
  if (turn.categories.empty()) return "";
  return absl::StrCat(
      Chapter("Pose error",
              "Mean absolute error of the right poses, modulo the object's symmetry. No bar: no "
              "pose was right."),
      Figure(DrawBars(turn)), Figure(DrawBars(shift)));
}

// Tables 1 and 2 of the paper.
std::string Times(const TimeFigures& times) {
  return absl::StrFormat(
      "<h3>Time</h3>\n<p>For a whole scene; other scenes were worked on at the same time.</p>\n"
      "<div class=\"wide\"><table><tr><th>scenes</th><th>mean ms</th><th>median ms</th>"
      "<th>95th percentile ms</th><th>longest ms</th></tr>\n<tr><td>%d</td><td>%.1f</td>"
      "<td>%.1f</td><td>%.1f</td><td>%.1f</td></tr></table></div>\n",
      times.scenes, times.mean_ms, times.median_ms, times.p95_ms, times.longest_ms);
}

std::string Curves(const CaseResult& result) {
  std::string out;
  const Curve recall = RecallOverAddS(result);
  if (!recall.empty()) {
    absl::StrAppend(&out, Figure(DrawLines({.title = "Recall over the ADD-S that is allowed",
                                            .x_label = "ADD-S, share of the diameter",
                                            .y_label = "recall",
                                            .x_range = {0, recall.back().first},
                                            .series = {{"recall", recall}}})));
  }
  ScoreCurves curves = OverScore(result);
  LineChart over_score{.title = "Precision and recall over the least score",
                       .x_label = "least score of an answer",
                       .y_label = "share",
                       .series = {{"precision", std::move(curves.precision)}}};
  if (!curves.recall.empty()) over_score.series.push_back({"recall", std::move(curves.recall)});
  absl::StrAppend(&out, Figure(DrawLines(over_score)));
  return absl::StrCat(Chapter("Thresholds",
                              "Left: how many questions are answered rightly when the pose may be "
                              "so far off. Right: what remains when answers with a lower score are "
                              "turned down, and how much of it is right."),
                      out);
}

std::string Reliability(const CaseResult& result) {
  BarChart chart{.title = "Share of right answers by score",
                 .unit = " %",
                 .categories = {},
                 .series = {{"right", {}, {}}, {"score", {}, {}}},
                 .scale_end = 100};
  for (const ScoreBin& bin : ReliabilityBins(result)) {
    if (bin.count == 0) continue;
    chart.categories.push_back(absl::StrFormat("%.1f to %.1f", bin.low, bin.low + 0.1));
    chart.series[0].values.push_back(100 * bin.right);
    chart.series[0].labels.push_back(absl::StrFormat("%.1f %% of %d", 100 * bin.right, bin.count));
    chart.series[1].values.push_back(100 * (bin.low + 0.05));
    chart.series[1].labels.push_back(absl::StrFormat("%.0f %%", 100 * (bin.low + 0.05)));
  }
  if (chart.categories.empty()) return "";
  return absl::StrCat(Chapter("What a score is worth",
                              "Answers by their score: the share whose object and pose are right, "
                              "beside the middle of the scores. A score that were a probability "
                              "would have bars of the same length."),
                      Figure(DrawBars(chart)));
}

}  // namespace

std::string SectionId(const std::string& case_name) {
  return absl::StrCat("case-", EscapeMarkup(case_name));
}

std::string CaseSection(const CaseResult& result) {
  const std::string& name = result.experiment.name;
  std::string out = absl::StrCat("<section id=\"", SectionId(name), "\">\n<h2>", EscapeMarkup(name),
                                 "</h2>\n<p>", EscapeMarkup(SettingsText(result)), "</p>\n");
  if (result.answers.empty()) return absl::StrCat(out, "<p>Nothing was asked.</p>\n</section>\n");
  const std::vector<ObjectFigures> figures = FiguresByObject(result);
  absl::StrAppend(&out, FalseRecognition(figures), PoseErrors(figures), Times(TimesOf(result)),
                  Curves(result), Reliability(result));
  absl::StrAppend(&out, ConfusionChapter(result), MatchingScores(result), MatchDrawings(result),
                  "</section>\n");
  return out;
}

}  // namespace graspdb::client
