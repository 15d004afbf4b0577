// All views of the catalogue while they are loaded.
#pragma once

#include <cstdint>
#include <deque>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "recognition/index/descriptor_index.h"
#include "recognition/models/taught.h"

namespace graspdb::server {

// All views at one revision, with their index.
struct LoadedViews {
  std::int64_t revision = 0;
  recognition::DescriptorIndex index;
  std::vector<std::shared_ptr<const recognition::TaughtView>> views;
  std::vector<std::string> left_out = {};  // names of views that cannot be used
};

// Adds views to an index as they are read. Other threads process them in portions, which takes
// longer than reading them; no second copy of all descriptors is ever in memory. Search results do
// not depend on the threads. Not thread-safe.
class ViewCollector {
 public:
  // `size` bins per descriptor.
  explicit ViewCollector(int size);

  void Add(recognition::IndexedView view);
  // The added views, as of `revision`; Add() must not be called after it.
  LoadedViews Finish(std::int64_t revision);

 private:
  void HandOutPortion();
  void TakeOldest();

  const std::size_t max_at_work_;
  recognition::DescriptorIndex index_;
  std::deque<std::future<recognition::DescriptorIndex>> at_work_;  // the oldest in front
  std::vector<std::shared_ptr<const recognition::TaughtView>> views_;
  std::vector<recognition::IndexedView> portion_;
};

}  // namespace graspdb::server
