#include <algorithm>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

constexpr double kCellPx = 27;
// Cells keep this much of the page's ground, so that numbers on them can be read.
constexpr double kStrongest = 0.55;

double LongestPx(const std::vector<std::string>& names) {
  double longest = 40;
  for (const std::string& name : names) longest = std::max(longest, TextWidth(name));
  return longest;
}

std::string Cell(const MatrixPlot& plot, std::size_t row, std::size_t column, double x, double y) {
  const std::vector<std::size_t>& counts = plot.counts[row];
  const std::size_t count = counts[column];
  if (count == 0) return "";
  const auto whole = std::accumulate(counts.begin(), counts.end(), std::size_t{0});
  const double share = static_cast<double>(count) / static_cast<double>(whole);
  const bool right = plot.right[row] == plot.columns[column];
  const std::string told = absl::StrCat(plot.row_label, " ", plot.rows[row], ", ",
                                        plot.column_label, " ", plot.columns[column], ": ", count);
  return absl::StrCat(
      "<rect class=\"", right ? "f0" : "f1", "\" fill-opacity=\"",
      absl::StrFormat("%.2f", kStrongest * (0.15 + 0.85 * share)), "\" x=\"", Px(x), "\" y=\"",
      Px(y), "\" width=\"", Px(kCellPx - 1), "\" height=\"", Px(kCellPx - 1), "\"><title>",
      EscapeMarkup(told), "</title></rect>\n",
      SvgText(x + kCellPx / 2 - 0.5, y + kCellPx / 2 + 4, "middle", absl::StrCat(count)));
}

std::string ColumnName(const std::string& name, double x, double y) {
  return absl::StrCat("<g transform=\"translate(", Px(x), " ", Px(y), ") rotate(-90)\">",
                      SvgText(0, 0, "start", name), "</g>\n");
}

}  // namespace

std::string DrawMatrix(const MatrixPlot& plot) {
  const double left = LongestPx(plot.rows) + 34;
  const double top = LongestPx(plot.columns) + 34;
  const double right = left + kCellPx * static_cast<double>(plot.columns.size());
  const double bottom = top + kCellPx * static_cast<double>(plot.rows.size());
  std::string content = SvgText((left + right) / 2, 14, "middle", plot.column_label);
  absl::StrAppend(&content, "<g transform=\"translate(14 ", Px((top + bottom) / 2),
                  ") rotate(-90)\">", SvgText(0, 0, "middle", plot.row_label), "</g>\n");
  for (std::size_t column = 0; column < plot.columns.size(); ++column) {
    const double x = left + kCellPx * static_cast<double>(column);
    absl::StrAppend(&content, ColumnName(plot.columns[column], x + kCellPx / 2 + 4, top - 6));
  }
  for (std::size_t row = 0; row < plot.rows.size(); ++row) {
    const double y = top + kCellPx * static_cast<double>(row);
    absl::StrAppend(&content, SvgText(left - 6, y + kCellPx / 2 + 4, "end", plot.rows[row]));
    for (std::size_t column = 0; column < plot.columns.size(); ++column) {
      absl::StrAppend(&content,
                      Cell(plot, row, column, left + kCellPx * static_cast<double>(column), y));
    }
  }
  absl::StrAppend(&content, "<path class=\"axis\" fill=\"none\" d=\"M", Px(left - 1), " ",
                  Px(top - 1), "H", Px(right), "V", Px(bottom), "H", Px(left - 1), "Z\"/>\n");
  return SvgFrame(std::max(right + 10, 160.0), bottom + 6, plot.title, content);
}

}  // namespace graspdb::client
