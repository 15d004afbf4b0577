// Resource names from user input.
#pragma once

#include <string>

namespace graspdb::client {

// `id` as a resource name of `collection`: "objects/mug" for "mug" and for "objects/mug".
inline std::string ResourceName(const std::string& collection, const std::string& id) {
  const std::string prefix = collection + "/";
  return id.starts_with(prefix) ? id : prefix + id;
}

}  // namespace graspdb::client
