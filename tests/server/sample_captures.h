// Synthetic frames of sample parts for the server's tests.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "graspdb/v1/geometry.pb.h"
#include "recognition/base/types.h"
#include "rendering/workpiece.h"

namespace graspdb::testing {

// Pose of a part: on the table, turned about z.
struct Stand {
  double x = 0;  // m
  double y = 0;  // m
  double turn_deg = 0;
};

// Measurements of the simulated depth camera, in counts of 0.1 mm.
struct Frame {
  recognition::CameraIntrinsics camera;
  std::vector<std::uint16_t> counts;                               // row by row; 0: no measurement
  recognition::Pose world_sensor = recognition::Pose::Identity();  // T_world_sensor
  recognition::Pose world_object = recognition::Pose::Identity();  // T_world_object
};

// The sample part of the given id.
const rendering::Workpiece& Part(const std::string& id);

// The part on the table.
Frame Photograph(const std::string& part, const Stand& stand, std::uint64_t seed);

// The table only.
Frame PhotographEmptyTable();

v1::DepthImage DepthImageOf(const Frame& frame);

// The same measurements as a cloud.
v1::PointCloud CloudOf(const Frame& frame);

// The part's points only.
v1::PointCloud SegmentedCloudOf(const std::string& part, const Stand& stand, std::uint64_t seed);

// A cloud of packed x, y, z floats.
v1::PointCloud PackedCloud(const recognition::Points& points);

v1::Pose PoseMessage(const recognition::Pose& pose);
v1::AxisAlignedBox BoxMessage(const Eigen::Vector3d& min, const Eigen::Vector3d& max);

// Distance between the origins of two poses, m.
double ShiftBetween(const recognition::Pose& a, const v1::Pose& b);

}  // namespace graspdb::testing
