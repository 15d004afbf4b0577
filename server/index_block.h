// Views with their descriptors as stored in an index file. Reading gives the written values bit for
// bit.
#pragma once

#include <vector>

#include "absl/status/statusor.h"
#include "recognition/index/descriptor_chunk.h"
#include "storage/records.pb.h"

namespace graspdb::server {

storage::IndexBlock BlockFromChunk(const recognition::DescriptorChunk& chunk);

// The views of a block, `size` bins per descriptor. DATA_LOSS for an invalid block.
absl::StatusOr<std::vector<recognition::IndexedView>> ViewsFromBlock(
    const storage::IndexBlock& block, int size);

}  // namespace graspdb::server
