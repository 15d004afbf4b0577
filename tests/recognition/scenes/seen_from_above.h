// A segment as refinement and verification take it, of a camera above it.
#pragma once

#include <optional>
#include <utility>

#include "recognition/matching/refinement.h"
#include "recognition/segmentation/segmentation.h"

namespace graspdb::testing {

// The view of a camera 1 m above the origin on `cloud` (world frame) alone.
struct SeenFromAbove {
  explicit SeenFromAbove(recognition::OrientedCloud seen)
      : cloud(std::move(seen)), columns(cloud), grid(cloud.points, 0.003F, 0.02F) {
    world_sensor.translation().z() = 1;
    world_sensor.linear() = Eigen::Vector3d(1, -1, -1).asDiagonal();
    recognition::Scan scan{.points = recognition::Transform(world_sensor.inverse(), cloud.points),
                           .world_sensor = world_sensor,
                           .region = {},
                           .segmented = true};
    recognition::Segment segment;
    for (std::size_t i = 0; i < scan.points.size(); ++i) {
      segment.indices.push_back(static_cast<std::int32_t>(i));
    }
    depth_buffer.emplace(scan, world_sensor, segment);
  }
  recognition::RefinementTarget Target(bool on_table) const {
    return {cloud, columns, grid, *depth_buffer, on_table};
  }

  recognition::OrientedCloud cloud;
  recognition::SoaCloud columns;
  recognition::NearestGrid grid;
  recognition::Pose world_sensor = recognition::Pose::Identity();
  std::optional<recognition::DepthBuffer> depth_buffer;
};

}  // namespace graspdb::testing
