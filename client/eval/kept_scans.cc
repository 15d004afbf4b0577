#include "client/eval/kept_scans.h"

#include <algorithm>

namespace graspdb::client {
namespace {

using Eigen::Vector3d;
using recognition::Points;

constexpr std::size_t kMaxPoints = 1500;
constexpr double kTableM = 0.004;  // lower points are the table

// Every n-th point, so that at most kMaxPoints are left.
Points Thinned(const Points& points) {
  const std::size_t step = points.size() / kMaxPoints + 1;
  Points out;
  for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

// Points of the scan no farther than `radius_m` from `center` (world frame), without the table.
Points Around(const Vector3d& center, double radius_m, const recognition::Scan& scan) {
  Points out;
  for (const Eigen::Vector3f& p : scan.points) {
    if (!p.allFinite() || p.z() <= 0) continue;
    const Vector3d world = *scan.world_sensor * p.cast<double>();
    if (world.z() < kTableM || (world - center).norm() > radius_m) continue;
    out.push_back(world.cast<float>());
  }
  return Thinned(out);
}

}  // namespace

std::vector<std::size_t> WorstFirst(const CaseResult& result) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < result.answers.size(); ++i) {
    if (result.answers[i].known || !result.answers[i].object_right) order.push_back(i);
  }
  std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
    const Answer& x = result.answers[a];
    const Answer& y = result.answers[b];
    if (x.object_right != y.object_right) return !x.object_right;
    return x.error.hausdorff_m > y.error.hausdorff_m;
  });
  return order;
}

absl::Status KeepScans(std::size_t count, const std::vector<PlannedCapture>& plan,
                       const TrialRenderer& renderer, CaseResult* result) {
  if (count == 0) return absl::OkStatus();
  std::vector<std::size_t> worst = WorstFirst(*result);
  worst.resize(std::min(worst.size(), count));
  for (const std::size_t i : worst) {
    const Answer& answer = result->answers[i];
    const auto trial =
        renderer.Render(plan[answer.scene], ObstacleOf(result->experiment, answer.scene));
    if (!trial.ok()) return trial.status();
    const TriangleMesh& mesh = result->set.parts[answer.part].mesh;
    const recognition::Box box = BoundsOf(mesh);
    const Vector3d center = answer.truth * Vector3d((box.min + box.max) / 2);
    result->scans[i] = Around(center, 0.6 * (box.max - box.min).norm(), trial->scan);
  }
  return absl::OkStatus();
}

}  // namespace graspdb::client
