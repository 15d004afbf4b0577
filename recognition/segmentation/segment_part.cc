#include "recognition/segmentation/segment_part.h"

namespace graspdb::recognition {

Segment PartOf(const Scan& scan, const Segmentation& segmentation, const Segment& whole,
               const IsPartOf& is_part, const IsCancelled& is_cancelled) {
  CancellationPoll poll(is_cancelled);
  Segment out;
  for (std::size_t i = 0; i < whole.cloud.points.size(); ++i) {
    if (poll.AfterPoints()) return out;
    if (!is_part(whole.cloud.points[i])) continue;
    out.cloud.points.push_back(whole.cloud.points[i]);
    out.cloud.normals.push_back(whole.cloud.normals[i]);
  }
  const Eigen::Isometry3f world_sensor = segmentation.world_sensor.cast<float>();
  for (const std::int32_t i : whole.indices) {
    if (poll.AfterPoints()) return out;
    if (is_part(world_sensor * scan.PointAt(i))) out.indices.push_back(i);
  }
  out.centroid = Centroid(out.cloud.points);
  return out;
}

}  // namespace graspdb::recognition
