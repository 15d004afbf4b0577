// Views of the sample parts by a simulated camera, and of scaled variants.
#pragma once

#include <Eigen/Core>
#include <random>
#include <vector>

#include "recognition/base/types.h"
#include "rendering/workpiece.h"

namespace graspdb::bench {

// A view of one part.
struct SeenPart {
  std::size_t part = 0;  // position among the parts
  recognition::Pose world_object = recognition::Pose::Identity();
  recognition::Pose world_sensor = recognition::Pose::Identity();
  recognition::Points points;        // as measured, world frame
  recognition::OrientedCloud cloud;  // their voxels, world frame
};

// The parts captured by a simulated Kinect v2 from all around; views without a part are left out.
std::vector<SeenPart> SeeParts(const std::vector<client::Workpiece>& parts);

// A point of the object in `seen`, world frame, with the object scaled along its axes.
Eigen::Vector3f StretchedPoint(const SeenPart& seen, const Eigen::Vector3f& factors,
                               const Eigen::Vector3f& point);

// The cloud of the scaled object.
recognition::OrientedCloud StretchedCloud(const SeenPart& seen, const Eigen::Vector3f& factors);

// Scale factors of each part along its axes, by variant; the first one is not scaled. The same on
// every run.
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
