#include "recognition/descriptors/descriptor_parameters.h"

#include "absl/strings/str_format.h"

namespace graspdb::recognition {

std::string DescriptorParameters::Fingerprint() const {
  // The leading number is the version of the code that turns points into bins.
  return absl::StrFormat("2 %s voxel=%.6f normal=%.6f", DescriptorName(kind), voxel_size_m,
                         normal_radius_m);
}

}  // namespace graspdb::recognition
