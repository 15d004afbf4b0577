#include "recognition/matching/single_view_baseline.h"

namespace graspdb::recognition {

absl::StatusOr<ViewAlignment> AlignView(const TaughtView& view, const Segment& segment,
                                        ViewClouds& clouds, const MatchingParameters& parameters) {
  const auto cloud = clouds.Load(view);
  if (!cloud.ok()) return cloud.status();
  const Points& points = (*cloud)->points;
  const PointSearch search(segment.cloud.points);
  ViewAlignment out;
  Pose shift = Pose::Identity();
  shift.translation() = segment.centroid - Centroid(points);
  out.rough = shift * view.world_object;
  out.registration = Align(points, {segment.cloud, search}, shift, parameters);
  out.refined = out.registration.target_source * view.world_object;

  const Points moved = Transform(out.registration.target_source, points);
  const double view_by_scan = Support(moved, search, parameters.support_distance_m);
  const double scan_by_view =
      Support(segment.cloud.points, PointSearch(moved), parameters.support_distance_m);
  const double sum = view_by_scan + scan_by_view;
  out.score = sum > 0 ? 2 * view_by_scan * scan_by_view / sum : 0;
  return out;
}

}  // namespace graspdb::recognition
