#include <algorithm>
#include <cmath>
#include <limits>

#include "absl/strings/str_cat.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

constexpr double kSidePx = 300;
constexpr double kMarginPx = 8;

// The square around all points.
struct Square {
  double left = 0;
  double top = 0;
  double side = 1;
};

Square Around(const PointPlot& plot) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::array<double, 2> low = {kInfinity, kInfinity};
  std::array<double, 2> high = {-kInfinity, -kInfinity};
  for (const PointGroup& group : plot.groups) {
    for (const std::array<double, 2>& p : group.points) {
      for (std::size_t k = 0; k < 2; ++k) {
        low[k] = std::min(low[k], p[k]);
        high[k] = std::max(high[k], p[k]);
      }
    }
  }
  if (!(low[0] <= high[0])) return {};
  const double side = std::max({high[0] - low[0], high[1] - low[1], 1e-9});
  return {
      .left = (low[0] + high[0] - side) / 2, .top = (low[1] + high[1] - side) / 2, .side = side};
}

// All points as one path of dots: a line without length that has round ends.
std::string Dots(const PointGroup& group, const Square& square) {
  const double scale = (kSidePx - 2 * kMarginPx) / square.side;
  std::string path;
  for (const std::array<double, 2>& p : group.points) {
    absl::StrAppend(&path, "M", Px(kMarginPx + (p[0] - square.left) * scale), " ",
                    Px(kMarginPx + (p[1] - square.top) * scale), "h0");
  }
  if (path.empty()) return "";
  const std::string color =
      group.color == kTextColor ? "st" : absl::StrCat("s", group.color % kSeriesColors);
  return absl::StrCat("<path class=\"dots ", color, "\" stroke-width=\"", Px(group.size_px),
                      "\" d=\"", path, "\"><title>", EscapeMarkup(group.name), "</title></path>\n");
}

}  // namespace

std::string DrawPoints(const PointPlot& plot) {
  const Square square = Around(plot);
  std::string content;
  for (const PointGroup& group : plot.groups) absl::StrAppend(&content, Dots(group, square));
  return SvgFrame(kSidePx, kSidePx, plot.title, content);
}

}  // namespace graspdb::client
