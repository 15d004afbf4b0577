#include "lab/experiment/report/confusion_chapter.h"

#include <algorithm>
#include <functional>
#include <set>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/case_curves.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

constexpr std::size_t kLargestMatrix = 30;

std::set<std::string> AskedObjects(const Confusions& confusions) {
  std::set<std::string> asked;
  for (const auto& [pair, count] : confusions) asked.insert(pair.first);
  return asked;
}

// Objects that were not taught; it is right to name none for them.
std::set<std::string> UntaughtObjects(const CaseResult& result) {
  std::set<std::string> untaught;
  for (const Answer& a : result.answers) {
    if (!a.known) untaught.insert(result.set.parts[a.part].object_id);
  }
  return untaught;
}

std::string NameOrNone(const std::string& object) { return object.empty() ? "(none)" : object; }

std::string ConfusedPairs(const Confusions& confusions, const std::set<std::string>& untaught) {
  std::vector<std::pair<std::size_t, std::pair<std::string, std::string>>> pairs;
  for (const auto& [pair, count] : confusions) {
    const std::string right = untaught.contains(pair.first) ? "" : pair.first;
    if (pair.second != right) pairs.emplace_back(count, pair);
  }
  if (pairs.empty()) return "<p>No object was taken for another one.</p>\n";
  std::ranges::stable_sort(pairs, std::greater<>(), [](const auto& pair) { return pair.first; });
  std::string out = "<table><tr><th>asked</th><th>answered</th><th>times</th></tr>\n";
  for (const auto& [count, pair] : pairs) {
    absl::StrAppend(&out, "<tr><td>", EscapeMarkup(pair.first), "</td><td>",
                    EscapeMarkup(NameOrNone(pair.second)), "</td><td>", count, "</td></tr>\n");
  }
  return absl::StrCat("<div class=\"wide\">", out, "</table></div>\n");
}

std::string ConfusionMatrix(const Confusions& confusions, const std::set<std::string>& untaught) {
  const std::set<std::string> asked = AskedObjects(confusions);
  std::set<std::string> answered;
  for (const auto& [pair, count] : confusions) answered.insert(pair.second);
  MatrixPlot plot{.title = "Objects asked about and objects answered",
                  .row_label = "asked",
                  .column_label = "answered",
                  .rows = {asked.begin(), asked.end()},
                  .columns = {},
                  .counts = {},
                  .right = {}};
  for (const std::string& row : plot.rows) {
    plot.right.push_back(NameOrNone(untaught.contains(row) ? "" : row));
    auto& counts = plot.counts.emplace_back();
    for (const std::string& column : answered) {
      const auto found = confusions.find({row, column});
      counts.push_back(found == confusions.end() ? 0 : found->second);
    }
  }
  for (const std::string& column : answered) plot.columns.push_back(NameOrNone(column));
  return absl::StrCat("<figure>", DrawMatrix(plot), "</figure>\n");
}

}  // namespace

std::string ConfusionChapter(const CaseResult& result) {
  const Confusions confusions = ConfusionsOf(result);
  const std::set<std::string> untaught = UntaughtObjects(result);
  const bool as_matrix = AskedObjects(confusions).size() <= kLargestMatrix;
  return absl::StrCat(
      "<h3>What was taken for what</h3>\n<p>Objects asked about and objects "
      "answered.</p>\n",
      as_matrix ? ConfusionMatrix(confusions, untaught) : ConfusedPairs(confusions, untaught));
}

}  // namespace graspdb::client
