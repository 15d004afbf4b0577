// What a simulated camera sees of the sample parts, and of the same parts made longer or shorter.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "recognition/base/types.h"
#include "rendering/workpiece.h"

namespace graspdb::bench {

// What was seen of one part from one side.
struct SeenPart {
  std::size_t part = 0;  // its place among the parts
  recognition::Pose world_object = recognition::Pose::Identity();
  recognition::Pose world_sensor = recognition::Pose::Identity();
  recognition::Points points;        // as measured, world frame
  recognition::OrientedCloud cloud;  // their voxels, world frame
};

// The parts seen by a simulated Kinect v2 from all around; nothing where it shows no part.
std::vector<SeenPart> SeeParts(const std::vector<client::Workpiece>& parts);

// A point of the object in `seen`, world frame, if the object were stretched along its axes.
Eigen::Vector3f StretchedPoint(const SeenPart& seen, const Eigen::Vector3f& factors,
                               const Eigen::Vector3f& point);

// The cloud if the object were stretched so.
recognition::OrientedCloud StretchedCloud(const SeenPart& seen, const Eigen::Vector3f& factors);

// By how much each part is stretched along its axes, one variant after the other; the first one
// is not. The same on every run.
class Stretches {
 public:
  explicit Stretches(std::size_t parts) : parts_(parts) {}
  std::vector<Eigen::Vector3f> Next();

 private:
  std::size_t parts_;
  bool first_ = true;
  std::mt19937_64 random_{7};
};

}  // namespace graspdb::bench
