// The labels of objects.
#pragma once

#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "client/sdk/client.h"

namespace graspdb::client {

// Pairs of object (resource name) and label.
using LabelledObjects = std::set<std::pair<std::string, std::string>>;

// Lists the objects again whenever the catalogue or its revision differs. Thread-safe.
class Labels {
 public:
  // `client` must outlive this.
  explicit Labels(Client& client) : client_(client) {}

  // As of this revision of the catalogue with this id, or of a later one if there is one already.
  // Servers of earlier versions send no id: then a restored catalogue is known by its older
  // revision only. Errors of the server.
  absl::StatusOr<std::shared_ptr<const LabelledObjects>> At(const std::string& catalog_id,
                                                            std::int64_t revision);

 private:
  Client& client_;
  absl::Mutex mutex_;
  std::string catalog_id_ ABSL_GUARDED_BY(mutex_);
  std::int64_t revision_ ABSL_GUARDED_BY(mutex_) = -1;
  std::shared_ptr<const LabelledObjects> objects_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::client
