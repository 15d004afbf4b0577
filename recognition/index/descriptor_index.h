// Nearest neighbours among the descriptors of all views.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "recognition/index/descriptor_chunk.h"
#include "recognition/models/taught.h"

namespace graspdb::recognition {

// A view found by a search.
struct Match {
  std::shared_ptr<const TaughtView> view;
  double distance = 0;  // chi-square, sum((a - b)^2 / (a + b)): 2 if they share no bin
};

// An immutable index; copies share their content, and With/Without share unchanged chunks, so that
// a write costs one chunk and not the whole. Searches are exact: bytes select the views that may be
// among the nearest (see DescriptorChunk), whose distances are then computed. Results do not depend
// on the insertion order. Thread-safe.
class DescriptorIndex {
 public:
  // `size` bins a descriptor.
  explicit DescriptorIndex(int size);

  // This index and more views, whose names must be new.
  DescriptorIndex With(std::span<const IndexedView> views) const;

  // This index and the views of `other`, whose names must be new here. Shares the content of both.
  DescriptorIndex Joined(const DescriptorIndex& other) const;

  // This index without the views of these resource names.
  DescriptorIndex Without(const std::unordered_set<std::string>& names) const;

  // Chunks, and what a filter left of them; null for nothing.
  using FilteredChunks = std::unordered_map<std::shared_ptr<const DescriptorChunk>,
                                            std::shared_ptr<const DescriptorChunk>>;
  // An index of the views for which `is_visible` holds. A search of it costs and finds what a
  // search of an index of only these views does. `known` has the chunks of an earlier call with the
  // same filter, which are not filtered again, and gets those of this one.
  DescriptorIndex Filtered(const std::function<bool(const TaughtView&)>& is_visible,
                           FilteredChunks* known) const;

  // The `count` nearest views, nearest first; equal distances by name.
  std::vector<Match> Nearest(const Descriptor& query, int count) const;

  std::size_t view_count() const { return view_count_; }

  // All views, some hundreds at a time.
  std::span<const std::shared_ptr<const DescriptorChunk>> chunks() const { return chunks_; }

  // An empty index that packs views as this one does, for parts that are built on other threads.
  // Not required for correctness.
  DescriptorIndex Empty() const;

 private:
  using Chunk = std::shared_ptr<const DescriptorChunk>;

  void FitProjection();
  void CodeAgain();

  std::size_t bins_;
  std::size_t view_count_ = 0;
  std::shared_ptr<const RootProjection> projection_;  // of new chunks; null: there is none
  std::size_t next_fit_;                              // at this many views
  std::vector<std::shared_ptr<const DescriptorChunk>> chunks_;
};

}  // namespace graspdb::recognition
