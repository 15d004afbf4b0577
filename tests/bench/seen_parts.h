// Views of the sample parts by a simulated camera, and of scaled variants.
#pragma once

#include <Eigen/Geometry>
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
std::vector<SeenPart> SeeParts(const std::vector<rendering::Workpiece>& parts);

// Scales the object in a view along its axes.
class Stretch {
 public:
  Stretch(const SeenPart& seen, const Eigen::Vector3f& factors)
      : world_object_(seen.world_object.cast<float>()),
        object_world_(world_object_.inverse()),
        factors_(factors) {}

  // A point of the object, world frame.
  Eigen::Vector3f operator()(const Eigen::Vector3f& point) const {
    return world_object_ * (object_world_ * point).cwiseProduct(factors_);
  }

 private:
  const Eigen::Isometry3f world_object_;
  const Eigen::Isometry3f object_world_;
  const Eigen::Vector3f factors_;
};

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
