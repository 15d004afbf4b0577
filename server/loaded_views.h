// All views of the catalogue while they are loaded.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"

namespace graspdb::server {

// Everything that is known of the views at one revision.
struct LoadedViews {
  std::int64_t revision = 0;
  recognition::DescriptorIndex index;
  std::vector<std::shared_ptr<const recognition::TaughtView>> views;
  std::optional<std::int64_t> file_revision = {};  // of the index file that they came from
  std::vector<std::string> left_out = {};          // names of views that cannot be used
};

// Puts views into an index as they come. Portions of them are worked up on other threads, which
// takes longer than reading them; no second copy of all descriptors is ever in memory. What is
// found in the result does not depend on the threads. Not thread-safe.
class ViewCollector {
 public:
  // `size` bins a descriptor.
  explicit ViewCollector(int size);

  void Add(recognition::IndexedView view);
  // What was added, as of `revision`; nothing can be added after it.
  LoadedViews Finish(std::int64_t revision);

 private:
  void HandOutPortion();
  void TakeOldest();

  const std::size_t most_at_work_;
  recognition::DescriptorIndex index_;
  std::deque<std::future<recognition::DescriptorIndex>> at_work_;  // the oldest in front
  std::vector<std::shared_ptr<const recognition::TaughtView>> views_;
  std::vector<recognition::IndexedView> portion_;
};

}  // namespace graspdb::server
