#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

constexpr double kLeftPx = 60;
constexpr double kTitlePx = 30;
constexpr double kWidthPx = 400;  // between the axes' ends
constexpr double kHeightPx = 220;
constexpr double kRightPx = 24;
constexpr double kBottomPx = 48;

// Maps values into the picture.
class Axes {
 public:
  explicit Axes(const LineChart& chart) : chart_(&chart) {}

  double X(double x) const { return kLeftPx + kWidthPx * Share(x, chart_->x_range); }
  double Y(double y) const { return kTitlePx + kHeightPx * (1 - Share(y, chart_->y_range)); }

 private:
  static double Share(double value, const std::array<double, 2>& range) {
    const double length = range[1] - range[0];
    return length > 0 ? std::clamp((value - range[0]) / length, 0.0, 1.0) : 0;
  }

  const LineChart* chart_;
};

// About five round numbers: steps of 1, 2 or 5 times a power of ten.
std::vector<double> Ticks(const std::array<double, 2>& range) {
  const double length = range[1] - range[0];
  if (!(length > 0)) return {range[0]};
  const double power = std::pow(10, std::floor(std::log10(length / 5)));
  double step = power;
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    step = factor * power;
    if (length / step <= 6) break;
  }
  std::vector<double> ticks;
  const auto first = static_cast<int>(std::ceil(range[0] / step - 1e-9));
  for (int i = first; i * step <= range[1] + 1e-9 * length; ++i) ticks.push_back(i * step);
  return ticks;
}

std::string Grid(const LineChart& chart, const Axes& axes) {
  std::string out;
  const double bottom = kTitlePx + kHeightPx;
  for (const double x : Ticks(chart.x_range)) {
    absl::StrAppend(&out, "<path class=\"grid\" d=\"M", Px(axes.X(x)), " ", Px(kTitlePx), "V",
                    Px(bottom), "\"/>", SvgText(axes.X(x), bottom + 16, "middle", Readable(x)));
  }
  for (const double y : Ticks(chart.y_range)) {
    absl::StrAppend(&out, "<path class=\"grid\" d=\"M", Px(kLeftPx), " ", Px(axes.Y(y)), "h",
                    Px(kWidthPx), "\"/>", SvgText(kLeftPx - 6, axes.Y(y) + 4, "end", Readable(y)));
  }
  absl::StrAppend(&out, "<path class=\"axis\" d=\"M", Px(kLeftPx), " ", Px(kTitlePx), "V",
                  Px(bottom), "h", Px(kWidthPx), "\"/>\n");
  absl::StrAppend(&out, SvgText(kLeftPx + kWidthPx / 2, bottom + 38, "middle", chart.x_label));
  absl::StrAppend(&out, "<g transform=\"translate(14 ", Px(kTitlePx + kHeightPx / 2),
                  ") rotate(-90)\">", SvgText(0, 0, "middle", chart.y_label), "</g>\n");
  return out;
}

std::string Line(const LineSeries& series, std::size_t which, const Axes& axes) {
  if (series.points.empty()) return "";
  std::string path;
  for (const auto& [x, y] : series.points) {
    absl::StrAppend(&path, path.empty() ? "M" : "L", Px(axes.X(x)), " ", Px(axes.Y(y)));
  }
  return absl::StrCat("<path class=\"line s", which % kSeriesColors, "\" d=\"", path, "\"><title>",
                      EscapeMarkup(series.name), "</title></path>\n");
}

}  // namespace

std::string DrawLines(const LineChart& chart) {
  const Axes axes(chart);
  std::string content = Grid(chart, axes);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < chart.series.size(); ++i) {
    names.push_back(chart.series[i].name);
    absl::StrAppend(&content, Line(chart.series[i], i, axes));
  }
  if (names.size() > 1) absl::StrAppend(&content, DrawLegend(names, kLeftPx, 14));
  return SvgFrame(kLeftPx + kWidthPx + kRightPx, kTitlePx + kHeightPx + kBottomPx, chart.title,
                  content);
}

}  // namespace graspdb::client
