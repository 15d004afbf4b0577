// Keeps the index beside the database no older than it must be.
#pragma once

#include <cstdint>
#include <optional>

#include "recognition/descriptors/descriptor_parameters.h"
#include "server/idle_task.h"
#include "server/live_catalogue.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Writes the index file of a catalogue on a thread of its own: at once where there is none that
// can be used, later when it is many changes behind and nothing has changed for a while, and when
// it is destroyed, if anything has changed. Requests do not wait for it. What cannot be written
// is told in the log; the next start then takes longer.
class IndexCheckpointer {
 public:
  // The references must outlive this.
  IndexCheckpointer(const storage::Catalogue& catalogue, LiveCatalogue& live,
                    const recognition::DescriptorParameters& parameters);
  ~IndexCheckpointer();
  IndexCheckpointer(const IndexCheckpointer&) = delete;
  IndexCheckpointer& operator=(const IndexCheckpointer&) = delete;

 private:
  void WriteIfBehind(std::int64_t changes);

  const storage::Catalogue& catalogue_;
  LiveCatalogue& live_;
  const recognition::DescriptorParameters parameters_;
  std::int64_t written_;  // revision of the file, as good as we could make it; on one thread
  std::optional<IdleTask> idle_task_;  // the last member: it uses the others
};

}  // namespace graspdb::server
