// The catalogue in memory, always as of the last acknowledged change.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "recognition/parameters.h"
#include "recognition/recognizer.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Follows a storage::Catalogue: loads it once, from the index beside the database if that is in
// order and else from the records, then applies every change before
// the call that made the change returns. Readers take a snapshot and never wait
// for a writer. Thread-safe.
class LiveCatalogue {
 public:
  // Loads `catalogue`, which must outlive this. Views whose descriptors were made
  // with other parameters are described again from their clouds, and stored.
  static absl::StatusOr<std::unique_ptr<LiveCatalogue>> Follow(
      storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters);
  ~LiveCatalogue();
  LiveCatalogue(const LiveCatalogue&) = delete;
  LiveCatalogue& operator=(const LiveCatalogue&) = delete;

  std::shared_ptr<const recognition::CatalogueSnapshot> snapshot() const;

  // The revision of the index file that it was loaded from; nothing where that was not used.
  std::optional<std::int64_t> file_revision() const { return file_revision_; }

  // What `work` makes of a snapshot. A view may be deleted between the snapshot and the loading of
  // its cloud: where `work` answers NOT_FOUND and there is a newer snapshot, it is asked again.
  template <typename Work>
  auto WithSnapshot(const Work& work) const {
    for (;;) {
      const std::shared_ptr<const recognition::CatalogueSnapshot> current = snapshot();
      auto result = work(*current);
      if (!absl::IsNotFound(result.status()) || snapshot() == current) return result;
    }
  }

 private:
  using Snapshot = recognition::CatalogueSnapshot;

  LiveCatalogue(storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters);
  absl::Status Load();
  void Apply(const storage::ChangeRecord& change);
  void Publish(Snapshot snapshot);

  storage::Catalogue& catalogue_;
  const recognition::DescriptorParameters parameters_;
  std::optional<std::int64_t> file_revision_;
  mutable absl::Mutex mutex_;
  std::shared_ptr<const Snapshot> snapshot_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace graspdb::server
