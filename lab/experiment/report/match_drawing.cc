#include "lab/experiment/report/match_drawing.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/kept_scans.h"
#include "lab/experiment/report/case_figures.h"
#include "lab/experiment/report/markup.h"
#include "lab/experiment/report/plot.h"

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Points;
using recognition::Pose;

constexpr std::size_t kScanPoints = 500;
// A point is hidden when another one in its cell of the image is so much nearer.
constexpr double kRasterPx = 2;
constexpr double kHiddenM = 0.01;

struct ImagePoint {
  double u = 0;  // px
  double v = 0;
  double depth_m = 0;
};

std::vector<ImagePoint> Project(const Points& points, const Pose& camera_points,
                                const recognition::CameraIntrinsics& k) {
  std::vector<ImagePoint> out;
  for (const Eigen::Vector3f& point : points) {
    const Vector3d p = camera_points * point.cast<double>();
    if (p.z() < 0.01) continue;  // behind the camera
    out.push_back({k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy, p.z()});
  }
  return out;
}

// Without the points on the far side of what is drawn.
std::vector<ImagePoint> Visible(const std::vector<ImagePoint>& points) {
  std::map<std::pair<int, int>, double> nearest;
  const auto cell = [](const ImagePoint& p) {
    return std::pair(static_cast<int>(std::floor(p.u / kRasterPx)),
                     static_cast<int>(std::floor(p.v / kRasterPx)));
  };
  for (const ImagePoint& p : points) {
    const auto [at, is_new] = nearest.emplace(cell(p), p.depth_m);
    at->second = std::min(at->second, p.depth_m);
  }
  std::vector<ImagePoint> out;
  std::ranges::copy_if(points, std::back_inserter(out), [&](const ImagePoint& p) {
    return p.depth_m <= nearest[cell(p)] + kHiddenM;
  });
  return out;
}

PointGroup GroupOf(const std::string& name, const std::vector<ImagePoint>& points,
                   std::size_t color, double size_px) {
  PointGroup out{.name = name, .points = {}, .color = color, .size_px = size_px};
  for (const ImagePoint& p : points) out.points.push_back({p.u, p.v});
  return out;
}

Points Thinned(const Points& points) {
  Points out;
  const std::size_t step = points.size() / kScanPoints + 1;
  for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

std::string Caption(const Answer& a, const PartSet& set) {
  std::string out = absl::StrCat("Question ", a.scene, ", ", set.parts[a.part].object_id, ": ",
                                 a.stable_pose.empty() ? "nothing" : ObjectOf(a.stable_pose));
  if (!a.stable_pose.empty()) absl::StrAppendFormat(&out, ", score %.3f", a.score);
  if (a.known && a.object_right && a.posed) {
    absl::StrAppendFormat(&out, ", farthest point %.1f mm off, ADD-S %.1f mm",
                          a.error.hausdorff_m * 1e3, a.error.add_s_m * 1e3);
  }
  if (a.listed) absl::StrAppend(&out, "; not the first reading, one of those listed");
  return out;
}

std::string Drawing(const CaseResult& result, std::size_t position) {
  const Answer& a = result.answers[position];
  const recognition::CameraIntrinsics& k = result.experiment.asked.camera.intrinsics;
  const Pose camera_world = a.world_sensor.inverse();
  const auto model = [&](std::size_t part, const Pose& world_object) {
    return Visible(Project(result.set.shapes[part]->points, camera_world * world_object, k));
  };
  const std::string caption = Caption(a, result.set);
  PointPlot plot{.title = caption, .groups = {}};
  if (const auto scan = result.scans.find(position); scan != result.scans.end()) {
    plot.groups.push_back(
        GroupOf("scan", Project(Thinned(scan->second), camera_world, k), kTextColor, 2.6));
  }
  if (a.posed) plot.groups.push_back(GroupOf("truth", model(a.part, a.truth), 0, 2));
  if (const auto part = PartOfFound(a, result.set)) {
    plot.groups.push_back(GroupOf("match", model(*part, a.found), 1, 2));
  }
  return absl::StrCat("<figure>", DrawPoints(plot), "<figcaption>", EscapeMarkup(caption),
                      "</figcaption></figure>\n");
}

}  // namespace

std::string MatchDrawings(const CaseResult& result) {
  std::vector<std::size_t> worst = WorstFirst(result);
  worst.resize(std::min(worst.size(), kDrawnAnswers));
  if (worst.empty()) return "";
  std::string out = absl::StrCat(
      "<h3>Scan and match</h3>\n<p>The answers that are farthest off, the worst first, as the "
      "camera "
      "sees them: ",
      result.scans.empty() ? "" : "the scan in the colour of the text, ",
      "points of the model where it <b class=\"key0\">truly is</b> and where it was "
      "<b class=\"key1\">found</b>.</p>\n");
  for (const std::size_t position : worst) absl::StrAppend(&out, Drawing(result, position));
  return out;
}

}  // namespace graspdb::client
