// The catalogue as recognition needs it.
#pragma once

#include <cstdint>
#include <memory>

#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"

namespace graspdb::recognition {

// All taught data as of one revision. Immutable.
struct CatalogueSnapshot {
  std::int64_t revision = 0;
  DescriptorIndex index;
  // By resource name.
  std::shared_ptr<const TaughtPoses> stable_poses;
};

}  // namespace graspdb::recognition
