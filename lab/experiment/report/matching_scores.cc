#include "lab/experiment/report/matching_scores.h"

#include <algorithm>
#include <span>

#include "absl/strings/str_cat.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/kept_scans.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

using recognition::Candidate;

constexpr std::size_t kShown = 10;

// Null where no answer has candidates.
const Answer* WorstWithCandidates(const CaseResult& result) {
  for (const std::size_t i : WorstFirst(result)) {
    if (!result.answers[i].candidates.empty()) return &result.answers[i];
  }
  const auto any =
      std::ranges::find_if(result.answers, [](const Answer& a) { return !a.candidates.empty(); });
  return any == result.answers.end() ? nullptr : &*any;
}

struct Charts {
  BarChart distances;
  BarChart scores;
};

Charts ChartsOf(std::span<const Candidate> shown, const Answer& answer) {
  Charts out{.distances = {.title = "Descriptor distance of the nearest views",
                           .unit = "",
                           .categories = {},
                           .series = {{"descriptor distance, less is nearer", {}}}},
             .scores = {.title = "Verification score of the nearest views",
                        .unit = "",
                        .categories = {},
                        .series = {{"verification score", {}}},
                        .scale_end = 1}};
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const std::string stable_pose = shown[i].view ? shown[i].view->stable_pose : "";
    const std::string name = absl::StrCat(i + 1, ". ", ObjectOf(stable_pose));
    const bool is_chosen = shown[i].view && shown[i].view->name == answer.view;
    for (BarChart* chart : {&out.distances, &out.scores}) {
      chart->categories.push_back(name);
      chart->marked.push_back(is_chosen);
    }
    out.distances.series[0].values.push_back(shown[i].descriptor_distance);
    out.scores.series[0].values.push_back(shown[i].verification_score.value_or(kNoBar));
  }
  return out;
}

}  // namespace

std::string MatchingScores(const CaseResult& result) {
  const Answer* answer = WorstWithCandidates(result);
  if (answer == nullptr) return "";
  const std::span<const Candidate> all = answer->candidates;
  const Charts charts = ChartsOf(all.first(std::min(all.size(), kShown)), *answer);
  const bool is_marked =
      std::ranges::find(charts.scores.marked, true) != charts.scores.marked.end();
  const std::string words = absl::StrCat(
      "Question ", answer->scene, ", ", StablePoseName(result.set.parts[answer->part]), ": the ",
      charts.scores.categories.size(), " views with the nearest descriptors. ",
      is_marked              ? "The framed one became the answer."
      : answer->view.empty() ? "None was near enough to be an answer."
                             : "The answer came from a view farther down.",
      " No bar: the view was not verified.");
  return absl::StrCat("<h3>First matching scores</h3>\n<p>", EscapeMarkup(words), "</p>\n<figure>",
                      DrawBars(charts.distances), "</figure>\n<figure>", DrawBars(charts.scores),
                      "</figure>\n");
}

}  // namespace graspdb::client
