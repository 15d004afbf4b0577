#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

constexpr double kBarPx = 13;
constexpr double kGapPx = 7;          // between groups
constexpr double kScalePx = 360;      // width of the longest bar
constexpr double kLegendPx = 26;      // legend
constexpr double kLegendItemPx = 30;  // beside its name

double ScaleEnd(const BarChart& chart) {
  double end = chart.scale_end;
  if (end > 0) return end;
  for (const BarSeries& s : chart.series) {
    for (const double value : s.values) end = std::isfinite(value) ? std::max(end, value) : end;
  }
  return end > 0 ? end : 1;
}

std::string LabelOf(const BarChart& chart, const BarSeries& series, std::size_t category) {
  if (category < series.labels.size()) return series.labels[category];
  return absl::StrCat(Readable(series.values[category]), chart.unit);
}

// The bar of one series; `y` is its upper edge.
std::string Bar(const BarChart& chart, std::size_t which, std::size_t category, double left,
                double y) {
  const BarSeries& series = chart.series[which];
  if (category >= series.values.size() || !std::isfinite(series.values[category])) return "";
  const double length = kScalePx * std::clamp(series.values[category] / ScaleEnd(chart), 0.0, 1.0);
  const std::string label = LabelOf(chart, series, category);
  return absl::StrCat(
      "<rect class=\"f", which % kSeriesColors, "\" x=\"", Px(left), "\" y=\"", Px(y),
      "\" width=\"", Px(length), "\" height=\"", Px(kBarPx - 1), "\"><title>",
      EscapeMarkup(absl::StrCat(chart.categories[category], ", ", series.name, ": ", label)),
      "</title></rect>\n", SvgText(left + length + 5, y + kBarPx - 2.5, "start", label));
}

double LeftMargin(const BarChart& chart) {
  double left = 40;
  for (const std::string& name : chart.categories) left = std::max(left, TextWidth(name) + 14);
  return left;
}

double LabelWidth(const BarChart& chart) {
  double width = 60;
  for (const BarSeries& s : chart.series) {
    for (std::size_t i = 0; i < s.values.size(); ++i) {
      width = std::max(width, TextWidth(LabelOf(chart, s, i)) + 14);
    }
  }
  return width;
}

}  // namespace

std::string DrawBars(const BarChart& chart) {
  const double left = LeftMargin(chart);
  const double group = kBarPx * static_cast<double>(chart.series.size()) + kGapPx;
  const double height = kLegendPx + group * static_cast<double>(chart.categories.size()) + 4;
  std::vector<std::string> names;
  for (const BarSeries& s : chart.series) names.push_back(s.name);
  const double width = left + std::max(kScalePx + LabelWidth(chart), LegendWidth(names));
  std::string content = DrawLegend(names, left, 14);
  for (std::size_t i = 0; i < chart.categories.size(); ++i) {
    const double y = kLegendPx + group * static_cast<double>(i);
    absl::StrAppend(&content,
                    SvgText(left - 7, y + (group - kGapPx) / 2 + 4, "end", chart.categories[i]));
    for (std::size_t which = 0; which < chart.series.size(); ++which) {
      absl::StrAppend(&content,
                      Bar(chart, which, i, left, y + kBarPx * static_cast<double>(which)));
    }
    if (i >= chart.marked.size() || !chart.marked[i]) continue;
    absl::StrAppend(&content, "<rect class=\"mark\" x=\"1\" y=\"", Px(y - 3), "\" width=\"",
                    Px(width - 2), "\" height=\"", Px(group - 1), "\"/>\n");
  }
  absl::StrAppend(&content, "<path class=\"axis\" d=\"M", Px(left), " ", Px(kLegendPx - 4), "V",
                  Px(height - 2), "\"/>\n");
  return SvgFrame(width, height, chart.title, content);
}

std::string DrawLegend(const std::vector<std::string>& names, double x, double y) {
  std::string out;
  for (std::size_t i = 0; i < names.size(); ++i) {
    absl::StrAppend(&out, "<rect class=\"f", i % kSeriesColors, "\" x=\"", Px(x), "\" y=\"",
                    Px(y - 9), "\" width=\"10\" height=\"10\"/>\n",
                    SvgText(x + 15, y, "start", names[i]));
    x += kLegendItemPx + TextWidth(names[i]);
  }
  return out;
}

double LegendWidth(const std::vector<std::string>& names) {
  double out = 0;
  for (const std::string& name : names) out += kLegendItemPx + TextWidth(name);
  return out;
}

}  // namespace graspdb::client
