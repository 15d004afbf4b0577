// The approximate index of a live catalogue, saved in a file beside the database;
// docs/adr/0020-flann-finds-candidates-and-chi-square-ranks.md.
#pragma once

#include <cstddef>
#include <optional>

#include "absl/status/status.h"
#include "recognition/descriptors/descriptor_parameters.h"
#include "server/idle_task.h"
#include "server/live_catalogue.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Loads the index from its file, or builds it, when constructed: 10 s for a million views. Rebuilds
// it in the background (IdleTask) once more than a fifth of its views were added or deleted.
// Requests do not wait for that: newer views are searched exactly.
class ApproximateIndexBuilder {
 public:
  // The references must outlive this.
  ApproximateIndexBuilder(const storage::Catalogue& catalogue, LiveCatalogue& live,
                          const recognition::DescriptorParameters& parameters);
  ~ApproximateIndexBuilder() = default;
  ApproximateIndexBuilder(const ApproximateIndexBuilder&) = delete;
  ApproximateIndexBuilder& operator=(const ApproximateIndexBuilder&) = delete;

 private:
  void RebuildIfOutdated();
  absl::Status Load();
  absl::Status Write(const recognition::ApproximateIndex& index);
  void Rebuild();

  const storage::Catalogue& catalogue_;
  LiveCatalogue& live_;
  const recognition::DescriptorParameters parameters_;
  std::size_t tried_ = 0;  // views of the catalogue at the last rebuild
  bool on_file_ = false;   // whether the file has the index that was built or loaded last
  std::optional<IdleTask> idle_task_;  // the last member: it uses the others
};

}  // namespace graspdb::server
