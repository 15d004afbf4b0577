#include "client/cell/agent/jobs/labels.h"

#include <vector>

#include "base/status_macros.h"

namespace graspdb::client {

absl::StatusOr<std::shared_ptr<const LabelledObjects>> Labels::At(const std::string& catalog_id,
                                                                  std::int64_t revision) {
  {
    absl::MutexLock lock(&mutex_);
    if (catalog_id_ == catalog_id && revision_ == revision) return objects_;
  }
  ASSIGN_OR_RETURN(const std::vector<v1::Object> listed, client_.ListObjects());
  auto objects = std::make_shared<LabelledObjects>();
  for (const v1::Object& object : listed) {
    for (const std::string& label : object.labels()) objects->emplace(object.name(), label);
  }
  absl::MutexLock lock(&mutex_);
  catalog_id_ = catalog_id;
  revision_ = revision;
  objects_ = std::move(objects);
  return objects_;
}

}  // namespace graspdb::client
