// Keeps the index file beside the database up to date.
#pragma once

#include <cstdint>
#include <optional>

#include "recognition/descriptors/descriptor_parameters.h"
#include "server/idle_task.h"
#include "server/live_catalogue.h"
#include "storage/catalogue.h"

namespace graspdb::server {

// Writes the index file of a catalogue on a thread of its own: immediately if there is no usable
// one, later when it is many changes behind and the catalogue is idle, and in the destructor, if
// the catalogue has changed. Requests do not wait for it. Failed writes are logged; the next start
// then takes longer.
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
  std::int64_t written_;  // revision of the last write, even if it failed; on one thread
  std::optional<IdleTask> idle_task_;  // the last member: it uses the others
};

}  // namespace graspdb::server
