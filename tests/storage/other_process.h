// The views that the other process of the tests writes, so that the tests can check them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace graspdb::storage {

// Name of the i-th view that `write` stores, from 0.
inline std::string WrittenViewName(std::int64_t i) {
  return "objects/mug/stablePoses/upright/views/" + std::to_string(i);
}

// Its cloud: of very different sizes, some for blob files.
inline std::string WrittenCloud(std::int64_t i) {
  const auto size = static_cast<std::size_t>(10 + 9000 * (i % 7));
  std::string cloud;
  while (cloud.size() < size) cloud += std::to_string(i * 7919 + static_cast<int>(cloud.size()));
  return cloud;
}

// Id of the i-th request of `report`, from 0.
inline std::string WrittenRequestId(std::int64_t i) { return "request-" + std::to_string(i); }

}  // namespace graspdb::storage
