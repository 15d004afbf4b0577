// A rigid motion in single precision, for inner loops.
#pragma once

#include "recognition/base/types.h"
#include "recognition/simd/surface_kernels.h"

namespace graspdb::recognition {

// T_a_b as a Pose has it, metres, written out: Eigen's general product of transforms is called, not
// inlined.
class RigidTransform {
 public:
  explicit RigidTransform(const Pose& pose)
      : RigidTransform(Eigen::Isometry3f(pose.cast<float>())) {}
  explicit RigidTransform(const Eigen::Isometry3f& pose) {
    Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(m_.rotation[0]) = pose.linear();
    Eigen::Map<Eigen::Vector3f>(m_.translation) = pose.translation();
  }

  // From frame b to frame a.
  Eigen::Vector3f Point(const Eigen::Vector3f& p) const {
    return {Along(0, p) + m_.translation[0], Along(1, p) + m_.translation[1],
            Along(2, p) + m_.translation[2]};
  }
  // The same for SIMD code.
  const simd::Rigid& rigid() const { return m_; }

 private:
  float Along(std::size_t row, const Eigen::Vector3f& v) const {
    return m_.rotation[row][0] * v.x() + m_.rotation[row][1] * v.y() + m_.rotation[row][2] * v.z();
  }

  simd::Rigid m_;
};

}  // namespace graspdb::recognition
