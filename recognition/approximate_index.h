// Nearly all of the nearest views, without looking at every one: FLANN's hierarchical k-means tree.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/descriptor_chunk.h"
#include "recognition/root_projection.h"

namespace graspdb::recognition {

// A tree over the projections of descriptors (see RootProjection), in which a search looks at some
// thousand views. It proposes; what it proposes is ranked by the exact distance (DescriptorIndex).
//
// FLANN takes its random numbers from the system: two trees of the same views propose different
// ones. A tree that was saved and loaded proposes what it did before. Views that are gone stay in
// the tree and are passed over. Immutable; safe for concurrent reads.
class ApproximateIndex {
 public:
  using Chunk = std::shared_ptr<const DescriptorChunk>;

  // How thoroughly a search looks.
  struct Effort {
    int checks = 1024;  // views that are looked at, at least
    // So many of the projections' nearest are ranked exactly. Among a million views 200 leave out
    // 2.5 % of the 10 nearest of unknown parts and 400 leave out 1.7 %; 1,000 double the time.
    int proposals = 500;
  };
  // More than so many neighbours are not asked of the tree: the exact search is as fast.
  static constexpr std::size_t kMostNeighbors = 50;

  // Numbers of views in the tree. A view that is gone has no place.
  struct Place {
    const DescriptorChunk* chunk = nullptr;
    std::size_t row = 0;
  };

  // What is kept of a tree, besides the names of its views in the order of their numbers.
  struct Saved {
    std::string library;  // and its version
    RootProjection::Numbers projection;
    // FLANN's. It ends the process on bytes that it did not write: check where they come from.
    std::string tree;
    std::size_t view_count = 0;
    Effort effort;
    double recall_at_10 = 0;
  };

  // Over all views of some chunks, which have `size` bins each; a second for 100,000 views.
  // FAILED_PRECONDITION where no projection fits them, and for fewer than kMostNeighbors views;
  // INTERNAL when FLANN fails.
  static absl::StatusOr<std::shared_ptr<const ApproximateIndex>> Build(
      std::span<const Chunk> chunks, const Effort& effort);

  // The tree that was saved, over the same views in the same order; `chunks` hold those that
  // are still there. FAILED_PRECONDITION for another library's, INTERNAL when FLANN fails.
  static absl::StatusOr<std::shared_ptr<const ApproximateIndex>> Load(const Saved& saved,
                                                                      std::vector<Place> places,
                                                                      std::vector<Chunk> chunks);
  absl::StatusOr<Saved> Save() const;

  // The same with another effort, and the recall that was measured with it.
  std::shared_ptr<const ApproximateIndex> Calibrated(const Effort& effort,
                                                     double recall_at_10) const;

  ~ApproximateIndex() = default;
  ApproximateIndex(const ApproximateIndex&) = delete;
  ApproximateIndex& operator=(const ApproximateIndex&) = delete;

  // Numbers of views that are near, in no order; none of those that are `gone` (one a view; empty:
  // none are). INTERNAL when FLANN fails.
  absl::StatusOr<std::vector<std::size_t>> Propose(const Descriptor& query,
                                                   const std::vector<bool>& gone) const;

  std::span<const Place> places() const { return places_; }
  const Effort& effort() const { return effort_; }
  double recall_at_10() const { return recall_at_10_; }
  std::size_t byte_count() const;

 private:
  class Tree;  // FLANN's

  ApproximateIndex() = default;

  std::vector<Chunk> chunks_;  // which the places point to
  std::vector<Place> places_;
  std::shared_ptr<const RootProjection> projection_;
  std::shared_ptr<const Tree> tree_;
  Effort effort_;
  double recall_at_10_ = 0;
};

}  // namespace graspdb::recognition
