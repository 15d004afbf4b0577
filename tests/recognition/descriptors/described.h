#pragma once

#include <gtest/gtest.h>

#include <cstddef>

#include "recognition/descriptors/descriptor.h"

namespace graspdb::recognition {

// The descriptor of `cloud`; zeros and a failed expectation where there is none.
inline Descriptor Described(const OrientedCloud& cloud, const Eigen::Vector3d& viewpoint,
                            DescriptorKind kind) {
  const auto descriptor = Describe(cloud, viewpoint, kind);
  EXPECT_TRUE(descriptor.ok()) << descriptor.status();
  return descriptor.value_or(Descriptor(static_cast<std::size_t>(DescriptorSize(kind))));
}

}  // namespace graspdb::recognition
