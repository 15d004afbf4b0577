// Where the cloud of a view is. Internal to storage/.
#pragma once

#include <string>

#include "storage/records.pb.h"

namespace graspdb::storage {

// The key in the family `clouds`.
inline const std::string& CloudKeyOf(const ViewRecord& view) {
  return view.cloud_key().empty() ? view.name() : view.cloud_key();
}

}  // namespace graspdb::storage
