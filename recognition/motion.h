// A rigid motion in single precision, for inner loops.
#pragma once

#include "recognition/types.h"

namespace graspdb::recognition {

// T_a_b as a Pose has it, metres, written out: Eigen's general product of transforms is called, not
// inlined.
class Motion {
 public:
  explicit Motion(const Pose& pose)
      : r_(pose.linear().cast<float>()), t_(pose.translation().cast<float>()) {}
  explicit Motion(const Eigen::Isometry3f& pose) : r_(pose.linear()), t_(pose.translation()) {}

  // From frame b to frame a.
  Eigen::Vector3f Point(const Eigen::Vector3f& p) const {
    return {r_(0, 0) * p.x() + r_(0, 1) * p.y() + r_(0, 2) * p.z() + t_.x(),
            r_(1, 0) * p.x() + r_(1, 1) * p.y() + r_(1, 2) * p.z() + t_.y(),
            r_(2, 0) * p.x() + r_(2, 1) * p.y() + r_(2, 2) * p.z() + t_.z()};
  }
  Eigen::Vector3f Direction(const Eigen::Vector3f& d) const {
    return {r_(0, 0) * d.x() + r_(0, 1) * d.y() + r_(0, 2) * d.z(),
            r_(1, 0) * d.x() + r_(1, 1) * d.y() + r_(1, 2) * d.z(),
            r_(2, 0) * d.x() + r_(2, 1) * d.y() + r_(2, 2) * d.z()};
  }

 private:
  Eigen::Matrix3f r_;
  Eigen::Vector3f t_;
};

}  // namespace graspdb::recognition
