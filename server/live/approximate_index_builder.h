// The approximate index of a live catalogue, saved in a file beside the database;
// docs/adr/0020-flann-finds-candidates-and-chi-square-ranks.md.
#pragma once

#include <cstddef>

#include "absl/status/status.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "server/live/live_catalogue.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Loads the index from its file, or builds it, when constructed: 10 s for a million views. Requests
// do not wait for later rebuilds: newer views are searched exactly. Not thread-safe.
class ApproximateIndexBuilder {
 public:
  // The references must outlive this.
  ApproximateIndexBuilder(const storage::Catalogue& catalogue, LiveCatalogue& live,
                          const recognition::DescriptorParameters& parameters);
  ApproximateIndexBuilder(const ApproximateIndexBuilder&) = delete;
  ApproximateIndexBuilder& operator=(const ApproximateIndexBuilder&) = delete;

  // Rebuilds the index once more than a fifth of its views were added or deleted.
  void RebuildIfOutdated();

 private:
  absl::Status Load();
  absl::Status Write(const recognition::ApproximateIndex& index);
  void Rebuild();

  const storage::Catalogue& catalogue_;
  LiveCatalogue& live_;
  const recognition::DescriptorParameters parameters_;
  std::size_t tried_ = 0;  // views of the catalogue at the last rebuild
  bool on_file_ = false;   // whether the file has the index that was built or loaded last
};

}  // namespace graspdb::server
