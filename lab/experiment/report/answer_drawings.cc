#include "lab/experiment/report/answer_drawings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "lab/experiment/gallery.h"
#include "lab/experiment/report/case_figures.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector3d;
using google::protobuf::Value;
using recognition::Candidate;
using recognition::Points;
using recognition::Pose;

constexpr std::size_t kFirstMatches = 10;
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

void FillPixels(const std::vector<ImagePoint>& points, files::JsonObject out) {
  std::vector<double> u;
  std::vector<double> v;
  for (const ImagePoint& p : points) {
    u.push_back(std::round(10 * p.u) / 10);
    v.push_back(std::round(10 * p.v) / 10);
  }
  out.Set(files::Json("u", u), files::Json("v", v));
}

std::string Caption(const Answer& a, const PartSet& set) {
  std::string out = absl::StrCat("Query ", a.scene, ", ", set.parts[a.part].object_id, ": ",
                                 a.stable_pose.empty() ? "nothing" : ObjectOf(a.stable_pose));
  if (!a.stable_pose.empty()) absl::StrAppendFormat(&out, ", score %.3f", a.score);
  if (a.known && a.object_right && a.posed) {
    absl::StrAppendFormat(&out, ", farthest point %.1f mm off, ADD-S %.1f mm",
                          a.error.hausdorff_m * 1e3, a.error.add_s_m * 1e3);
  }
  if (a.listed) absl::StrAppend(&out, "; not the first reading, one of those listed");
  return out;
}

void FillDrawing(const CaseResult& result, std::size_t position, files::JsonObject out) {
  const Answer& a = result.answers[position];
  const recognition::CameraIntrinsics& k = result.experiment.queried.camera.intrinsics;
  const Pose camera_world = a.world_sensor.inverse();
  const auto model = [&](std::size_t part, const Pose& world_object) {
    return Visible(Project(result.set.shapes[part]->points, camera_world * world_object, k));
  };
  out.Set(files::Json("title", Caption(a, result.set)));
  if (const auto scan = result.scans.find(position); scan != result.scans.end()) {
    FillPixels(Project(scan->second, camera_world, k), out.Object("scan"));
  }
  if (a.posed) FillPixels(model(a.part, a.truth), out.Object("truth"));
  if (const auto part = PartOfFound(a, result.set)) {
    FillPixels(model(*part, a.found), out.Object("match"));
  }
}

// Null where no answer has candidates.
const Answer* WorstWithCandidates(const CaseResult& result) {
  for (const std::size_t i : WorstFirst(result)) {
    if (!result.answers[i].candidates.empty()) return &result.answers[i];
  }
  const auto any =
      std::ranges::find_if(result.answers, [](const Answer& a) { return !a.candidates.empty(); });
  return any == result.answers.end() ? nullptr : &*any;
}

}  // namespace

void FillDrawings(const CaseResult& result, files::JsonObject* out) {
  std::vector<std::size_t> worst = WorstFirst(result);
  worst.resize(std::min(worst.size(), kDrawnAnswers));
  out->List("drawings", worst, [&](std::size_t position, files::JsonObject drawing) {
    FillDrawing(result, position, drawing);
  });
}

void FillFirstMatches(const CaseResult& result, Value* value) {
  value->set_null_value(google::protobuf::NULL_VALUE);
  const Answer* answer = WorstWithCandidates(result);
  if (answer == nullptr) return;
  files::JsonObject out(value);
  out.Set(files::Json("scene", answer->scene),
          files::Json("stable_pose_query", StablePoseName(result.set.parts[answer->part])),
          files::Json("answered", !answer->view.empty()));
  const std::span<const Candidate> all = answer->candidates;
  out.List(
      "views", all.first(std::min(all.size(), kFirstMatches)),
      [&](const Candidate& candidate, files::JsonObject view) {
        view.Set(
            files::Json("object", ObjectOf(candidate.view ? candidate.view->stable_pose : "")),
            files::Json("descriptor_distance", candidate.descriptor_distance),
            files::Json("verification_score", candidate.verification_score.value_or(std::nan(""))),
            files::Json("chosen", candidate.view && candidate.view->name == answer->view));
      });
}

}  // namespace graspdb::lab
