// Prepared clouds of views, the most used ones in memory.
#pragma once

#include <list>
#include <memory>
#include <string>
#include <unordered_map>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "recognition/parameters.h"
#include "recognition/taught.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Loads clouds from the catalogue, makes them ready for the alignment, and keeps
// as many as `byte_budget` allows, the least recently used ones leaving first.
// Thread-safe; two threads that miss the same view at once both load it.
class ViewCloudCache : public recognition::ViewClouds {
 public:
  // `catalogue` must outlive this.
  ViewCloudCache(const storage::Catalogue& catalogue,
                 const recognition::DescriptorParameters& parameters, std::size_t byte_budget);

  // NOT_FOUND when the view was deleted after the caller took its snapshot.
  absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> Load(
      const recognition::TaughtView& view) override;

  // Bytes that the cached clouds take.
  std::size_t bytes() const;

 private:
  using Cloud = std::shared_ptr<const recognition::OrientedCloud>;
  struct Entry {
    std::string key;
    Cloud cloud;
    std::size_t bytes;
  };

  absl::StatusOr<Cloud> Read(const recognition::TaughtView& view) const;
  void Insert(std::string key, const Cloud& cloud);

  const storage::Catalogue& catalogue_;
  const recognition::DescriptorParameters parameters_;
  const std::size_t byte_budget_;
  mutable absl::Mutex mutex_;
  std::list<Entry> entries_ ABSL_GUARDED_BY(mutex_);  // the most recently used in front
  std::unordered_map<std::string, std::list<Entry>::iterator> by_key_ ABSL_GUARDED_BY(mutex_);
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace graspdb::server
