// Plots as SVG, to be put into a page with PageStyle(). They carry a title for those who cannot see
// them, take the page's colour for text and lines, and hold neither scripts nor references.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace graspdb::client {

// Colours there are for series; more of them begin again.
inline constexpr std::size_t kSeriesColors = 5;
inline constexpr double kNoBar = std::numeric_limits<double>::quiet_NaN();

// Horizontal bars: a group for each category, in it a bar for each series.
struct BarSeries {
  std::string name;
  std::vector<double> values;            // one a category, or kNoBar
  std::vector<std::string> labels = {};  // beside the bars; the values where it is empty
};
struct BarChart {
  std::string title;
  std::string unit;  // after the numbers of the scale
  std::vector<std::string> categories;
  std::vector<BarSeries> series;
  double scale_end = 0;           // 0: the largest value
  std::vector<bool> marked = {};  // categories that are drawn with a frame; none where it is empty
};
std::string DrawBars(const BarChart& chart);

// Lines over a common horizontal axis; both axes have round numbers.
struct LineSeries {
  std::string name;
  std::vector<std::pair<double, double>> points;  // x, y; in the order of x
};
struct LineChart {
  std::string title;
  std::string x_label;
  std::string y_label;
  std::array<double, 2> x_range = {0, 1};
  std::array<double, 2> y_range = {0, 1};
  std::vector<LineSeries> series;
};
std::string DrawLines(const LineChart& chart);

// Counts as a matrix of cells, the darker the larger their share of the row.
struct MatrixPlot {
  std::string title;
  std::string row_label;
  std::string column_label;
  std::vector<std::string> rows;
  std::vector<std::string> columns;
  std::vector<std::vector<std::size_t>> counts;  // row by row
  std::vector<std::string> right;  // for each row the column whose cell has another colour
};
std::string DrawMatrix(const MatrixPlot& plot);

// Points in the plane, x to the right, y down, the same scale for both. Later groups cover earlier
// ones.
struct PointGroup {
  std::string name;
  std::vector<std::array<double, 2>> points;
  std::size_t color = 0;  // of the series, or kTextColor
  double size_px = 2;
};
inline constexpr std::size_t kTextColor = kSeriesColors;
struct PointPlot {
  std::string title;
  std::vector<PointGroup> groups;
};
std::string DrawPoints(const PointPlot& plot);

// The names of series in their colours, from (x, y) to the right, 18 px high.
std::string DrawLegend(const std::vector<std::string>& names, double x, double y);
double LegendWidth(const std::vector<std::string>& names);  // px

}  // namespace graspdb::client
