#include "server/view_cloud_cache.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "server/records.h"

namespace graspdb::server {

ViewCloudCache::ViewCloudCache(const storage::Catalogue& catalogue,
                               const recognition::DescriptorParameters& parameters,
                               std::size_t byte_budget)
    : catalogue_(catalogue), parameters_(parameters), byte_budget_(byte_budget) {}

absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> ViewCloudCache::Load(
    const recognition::TaughtView& view) {
  // The content is part of the key: a name may come back with another cloud.
  std::string key = absl::StrCat(view.name, "@", view.content);
  {
    absl::MutexLock lock(&mutex_);
    if (const auto found = by_key_.find(key); found != by_key_.end()) {
      entries_.splice(entries_.begin(), entries_, found->second);
      return found->second->cloud;
    }
  }
  absl::StatusOr<Cloud> cloud = Read(view);
  if (cloud.ok()) Insert(std::move(key), *cloud);
  return cloud;
}

absl::StatusOr<ViewCloudCache::Cloud> ViewCloudCache::Read(
    const recognition::TaughtView& view) const {
  absl::StatusOr<std::string> packed = catalogue_.GetPackedCloud(view.name);
  if (!packed.ok()) return packed.status();
  absl::StatusOr<storage::ViewRecord> record = catalogue_.GetView(view.name);
  if (!record.ok()) return record.status();
  if (record->content_digest() != view.content) {
    return absl::NotFoundError(absl::StrCat(view.name, " was replaced"));
  }
  absl::StatusOr<recognition::OrientedCloud> cloud =
      CloudFromPacked(*packed, view.world_sensor, parameters_);
  if (!cloud.ok()) return cloud.status();
  return std::make_shared<const recognition::OrientedCloud>(*std::move(cloud));
}

void ViewCloudCache::Insert(std::string key, const Cloud& cloud) {
  const std::size_t bytes = 2 * sizeof(Eigen::Vector3f) * cloud->points.size() + 2 * key.size();
  absl::MutexLock lock(&mutex_);
  if (by_key_.contains(key)) return;  // another thread was faster
  entries_.push_front({key, cloud, bytes});
  by_key_.emplace(std::move(key), entries_.begin());
  bytes_ += bytes;
  while (bytes_ > byte_budget_ && !entries_.empty()) {
    bytes_ -= entries_.back().bytes;
    by_key_.erase(entries_.back().key);
    entries_.pop_back();
  }
}

std::size_t ViewCloudCache::bytes() const {
  absl::MutexLock lock(&mutex_);
  return bytes_;
}

}  // namespace graspdb::server
