// Approximate nearest neighbours: FLANN's hierarchical k-means tree.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "recognition/index/descriptor_chunk.h"
#include "recognition/index/root_projection.h"

namespace graspdb::recognition {

// A tree over the projections of descriptors (see RootProjection), of which a search checks some
// thousand. It finds candidates, which DescriptorIndex ranks by the exact distance.
//
// FLANN seeds from the system: two trees of the same views find different candidates. A tree that
// was saved and loaded finds the same ones. Deleted views stay in the tree and are skipped.
// Immutable, but for Calibrate; safe for concurrent reads.
class ApproximateIndex {
 public:
  using Chunk = std::shared_ptr<const DescriptorChunk>;

  struct SearchParameters {
    int checks = 1024;  // FLANN's SearchParams::checks: views whose distance is computed, at least
    // The nearest projections, which are ranked exactly. Among a million views 200 miss 2.5 % of
    // the 10 nearest of unknown parts and 400 miss 1.7 %; doubled, a search takes twice as long.
    int candidates = 500;
  };
  // The largest k that is searched for in the tree; for more the exact search is as fast.
  static constexpr std::size_t kMaxNeighbors = 50;

  // Location of a view's descriptor; null for a deleted view.
  struct Place {
    const DescriptorChunk* chunk = nullptr;
    std::size_t row = 0;
  };

  // Stored content of an index, besides the names of its views in the order of their numbers.
  struct Saved {
    std::string library;  // and its version
    RootProjection::Numbers projection;
    // Serialised by FLANN, which ends the process on bytes that it did not write: the caller must
    // have verified a checksum.
    std::string tree;
    std::size_t view_count = 0;
    SearchParameters search;
    double recall_at_10 = 0;
  };

  // An index of all views of `chunks`; 1 s for 100,000 views. FAILED_PRECONDITION where no
  // projection fits them, and for fewer than kMaxNeighbors views; INTERNAL when FLANN fails.
  static absl::StatusOr<std::shared_ptr<ApproximateIndex>> Build(std::span<const Chunk> chunks,
                                                                 const SearchParameters& search);

  // The saved index of the same views in the same order; `chunks` contain those that are not
  // deleted. FAILED_PRECONDITION for another library, other views or search parameters outside of
  // their limits; DATA_LOSS for a projection that is damaged; INTERNAL when FLANN fails.
  static absl::StatusOr<std::shared_ptr<const ApproximateIndex>> Load(const Saved& saved,
                                                                      std::vector<Place> places,
                                                                      std::vector<Chunk> chunks);
  // INTERNAL when FLANN fails.
  absl::StatusOr<Saved> Save() const;

  // Sets the search parameters and their measured recall. Not while another thread uses the index.
  void Calibrate(const SearchParameters& search, double recall_at_10) {
    search_ = search;
    recall_at_10_ = recall_at_10;
  }

  ~ApproximateIndex() = default;
  ApproximateIndex(const ApproximateIndex&) = delete;
  ApproximateIndex& operator=(const ApproximateIndex&) = delete;

  // Numbers of near views, unordered, without the `deleted` ones (one flag a view; empty: none is).
  // INTERNAL when FLANN fails.
  absl::StatusOr<std::vector<std::size_t>> FindCandidates(const Descriptor& query,
                                                          const std::vector<bool>& deleted) const;

  std::span<const Place> places() const { return places_; }
  const SearchParameters& search() const { return search_; }
  double recall_at_10() const { return recall_at_10_; }
  std::size_t byte_count() const;

 private:
  class Tree;  // FLANN's

  ApproximateIndex() = default;

  std::vector<Chunk> chunks_;  // which the places point to
  std::vector<Place> places_;
  std::shared_ptr<const RootProjection> projection_;
  std::shared_ptr<const Tree> tree_;
  SearchParameters search_;
  double recall_at_10_ = 0;
};

}  // namespace graspdb::recognition
