#include "lab/experiment/report/case_figures.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "absl/strings/str_split.h"
#include "lab/experiment/gallery.h"

namespace graspdb::lab {
namespace {

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

}  // namespace graspdb::lab
