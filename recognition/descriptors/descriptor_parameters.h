// Parameters of a descriptor.
#pragma once

#include <string>

#include "recognition/descriptors/descriptor.h"

namespace graspdb::recognition {

// Parameters of stored clouds and their descriptors, the same for the whole catalogue: descriptors
// with different values are not comparable.
struct DescriptorParameters {
  DescriptorKind kind = DescriptorKind::kGsh288;
  // Edge of a voxel, m (paper, section 3.1: 0.3 cm).
  double voxel_size_m = 0.003;
  // Radius of the neighbourhood that a normal is fitted to, m.
  double normal_radius_m = 0.010;

  // All values as text; descriptors with equal fingerprints are comparable.
  std::string Fingerprint() const;
};

}  // namespace graspdb::recognition
