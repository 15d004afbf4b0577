#include "tests/bench/seen_parts.h"

#include "lab/experiment/trials/trial.h"

namespace graspdb::bench {

using recognition::OrientedCloud;

std::vector<SeenPart> SeeParts(const std::vector<rendering::Workpiece>& parts) {
  const auto plan = rendering::PlanTurntable(parts, {});
  const auto renderer = lab::TrialRenderer::Create(parts, rendering::KinectV2());
  std::vector<SeenPart> out;
  if (!plan.ok() || !renderer.ok()) return out;
  for (const rendering::PlannedCapture& capture : *plan) {
    const auto trial = renderer->Render(capture);
    if (!trial.ok()) continue;
    recognition::StageLog log;
    auto found = recognition::SegmentScan(
        trial->scan, {}, {}, [] { return false; }, &log);
    if (!found.ok() || found->segments.empty()) continue;
    const rendering::Placement& placed = capture.placements.front();
    recognition::Segment& segment = found->segments.front();
    recognition::Points measured;
    for (const std::int32_t i : segment.indices) measured.push_back(trial->scan.PointAt(i));
    out.push_back({placed.part, placed.world_object, capture.world_sensor,
                   recognition::Transform(capture.world_sensor, measured),
                   std::move(segment.cloud)});
  }
  return out;
}

OrientedCloud StretchedCloud(const SeenPart& seen, const Eigen::Vector3f& factors) {
  const Eigen::Matrix3f turn = seen.world_object.cast<float>().linear();
  const Stretch stretch(seen, factors);
  OrientedCloud out;
  for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
    out.points.push_back(stretch(seen.cloud.points[i]));
    out.normals.emplace_back(
        turn * (turn.transpose() * seen.cloud.normals[i]).cwiseQuotient(factors).normalized());
  }
  return out;
}

std::vector<Eigen::Vector3f> Stretches::Next() {
  std::vector<Eigen::Vector3f> out(parts_, Eigen::Vector3f::Ones());
  if (first_) {
    first_ = false;
    return out;
  }
  const auto factor = [&] { return 0.6F + static_cast<float>(random_() % 1000) / 1000.0F; };
  for (Eigen::Vector3f& factors : out) factors << factor(), factor(), factor();
  return out;
}

}  // namespace graspdb::bench
