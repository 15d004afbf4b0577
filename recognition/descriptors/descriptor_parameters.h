// What a descriptor depends on besides the points.
#pragma once

#include <string>

#include "recognition/descriptors/descriptor.h"

namespace graspdb::recognition {

// What shapes a stored cloud and its descriptor. One for the whole catalogue:
// descriptors that were made with different values do not compare.
struct DescriptorParameters {
  DescriptorKind kind = DescriptorKind::kGsh288;
  // Edge of a voxel, m (paper, section 3.1: 0.3 cm).
  double voxel_size_m = 0.003;
  // Radius of the neighbourhood that a normal is fitted to, m.
  double normal_radius_m = 0.010;

  // Names all values; equal texts mean that descriptors compare.
  std::string Fingerprint() const;
};

}  // namespace graspdb::recognition
