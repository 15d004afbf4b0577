#include "lab/experiment/kept_scans.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "base/status_macros.h"

namespace graspdb::lab {
namespace {

using Eigen::Vector3d;
using recognition::Points;

constexpr std::size_t kMaxKeptPoints = 500;
constexpr double kTableM = 0.004;  // lower points are the table

// Every n-th point, so that at most kMaxKeptPoints are left.
Points Thinned(const Points& points) {
  const std::size_t step = points.size() / kMaxKeptPoints + 1;
  Points out;
  for (std::size_t i = 0; i < points.size(); i += step) out.push_back(points[i]);
  return out;
}

Eigen::Vector3f CenterOf(const rendering::MeasuredShape& shape) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& p : shape.points) box.extend(p);
  return box.isEmpty() ? Eigen::Vector3f::Zero() : Eigen::Vector3f(box.center());
}

// Points of the scan no farther than `radius_m` from `center` (world frame), without the table.
Points Around(const Vector3d& center, double radius_m, const recognition::Scan& scan,
              const recognition::Pose& world_sensor) {
  Points out;
  for (const Eigen::Vector3f& p : scan.points) {
    if (!p.allFinite() || p.z() <= 0) continue;
    const Vector3d world = world_sensor * p.cast<double>();
    if (!scan.segmented && (world.z() < kTableM || (world - center).norm() > radius_m)) continue;
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

absl::Status KeepScans(std::size_t count, const TrialSource& queries, CaseResult* result) {
  if (count == 0) return absl::OkStatus();
  std::vector<std::size_t> worst = WorstFirst(*result);
  worst.resize(std::min(worst.size(), count));
  for (const std::size_t i : worst) {
    const Answer& answer = result->answers[i];
    ASSIGN_OR_RETURN(const auto trial, queries.make(answer.scene));
    const rendering::MeasuredShape& shape = *result->set.shapes[answer.part];
    const Vector3d center = answer.truth * CenterOf(shape).cast<double>();
    result->scans[i] = Around(center, 0.6 * shape.diameter_m, trial.scan, answer.world_sensor);
  }
  return absl::OkStatus();
}

}  // namespace graspdb::lab
