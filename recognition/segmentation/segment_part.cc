#include "recognition/segmentation/segment_part.h"

#include <utility>

namespace graspdb::recognition {
namespace {

// Time to find the part of a point, ns.
constexpr std::size_t kPartNs = 100;

}  // namespace

std::vector<Segment> PartsOf(const Scan& scan, const Segmentation& segmentation,
                             const Segment& whole, std::size_t count, const PartNumber& number,
                             const IsCancelled& is_cancelled) {
  CancellationPoll poll(is_cancelled);
  std::vector<Segment> out(count);
  for (std::size_t i = 0; i < whole.cloud.points.size(); ++i) {
    if (poll.After(kPartNs)) return out;
    const int part = number(whole.cloud.points[i]);
    if (part < 0) continue;
    OrientedCloud& cloud = out[static_cast<std::size_t>(part)].cloud;
    cloud.points.push_back(whole.cloud.points[i]);
    cloud.normals.push_back(whole.cloud.normals[i]);
  }
  const Eigen::Isometry3f world_sensor = segmentation.world_sensor.cast<float>();
  for (const std::int32_t i : whole.indices) {
    if (poll.After(kPartNs)) return out;
    const int part = number(world_sensor * scan.PointAt(i));
    if (part >= 0) out[static_cast<std::size_t>(part)].indices.push_back(i);
  }
  for (Segment& part : out) part.centroid = Centroid(part.cloud.points);
  return out;
}

Segment PartOf(const Scan& scan, const Segmentation& segmentation, const Segment& whole,
               const IsPartOf& is_part, const IsCancelled& is_cancelled) {
  const PartNumber number = [&](const Eigen::Vector3f& p) { return is_part(p) ? 0 : -1; };
  return std::move(PartsOf(scan, segmentation, whole, 1, number, is_cancelled).front());
}

}  // namespace graspdb::recognition
