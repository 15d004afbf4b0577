// Views with their descriptors as an index file holds them. Bit for bit: what is read is what
// was written.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "recognition/index/descriptor_chunk.h"
#include "storage/records.pb.h"

namespace graspdb::server {

storage::IndexBlock BlockFromChunk(const recognition::DescriptorChunk& chunk);

// The views of a block, `size` bins a descriptor. DATA_LOSS for a block that BlockFromChunk
// cannot have made.
absl::StatusOr<std::vector<recognition::IndexedView>> ViewsFromBlock(
    const storage::IndexBlock& block, int size);

}  // namespace graspdb::server
