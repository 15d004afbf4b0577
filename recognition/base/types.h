// Value types that every step of the recognition shares.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

namespace graspdb::recognition {

// T_a_b, the pose of frame b in frame a: p_a = T_a_b * p_b. Metres.
using Pose = Eigen::Isometry3d;

// Points in metres, in the frame that the function documents.
using Points = std::vector<Eigen::Vector3f>;

// Unit vectors.
using Normals = std::vector<Eigen::Vector3f>;

// Positions in a cloud.
using Indices = std::vector<std::int32_t>;

// Points with their unit normals, one each.
struct OrientedCloud {
  Points points;
  Normals normals;
};

// A box along the axes of a frame, metres; its faces belong to it.
struct Box {
  Eigen::Vector3d min = Eigen::Vector3d::Zero();
  Eigen::Vector3d max = Eigen::Vector3d::Zero();

  bool Contains(const Eigen::Vector3d& p) const {
    return (p.array() >= min.array()).all() && (p.array() <= max.array()).all();
  }
};

// The pinhole model of a depth camera without distortion. Pixels.
struct CameraIntrinsics {
  int width = 0;
  int height = 0;
  double fx = 0;
  double fy = 0;
  double cx = 0;
  double cy = 0;
  bool operator==(const CameraIntrinsics&) const = default;
};

}  // namespace graspdb::recognition
