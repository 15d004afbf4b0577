// The views of a DescriptorIndex that a request meets.
#include <utility>

#include "recognition/index/descriptor_index.h"

namespace graspdb::recognition {
namespace {

// The chunk itself if all of its views are visible, null if none is.
std::shared_ptr<const DescriptorChunk> VisibleOf(
    const std::shared_ptr<const DescriptorChunk>& chunk,
    const std::function<bool(const TaughtView&)>& is_visible) {
  std::vector<std::size_t> rows;
  rows.reserve(chunk->size());
  for (std::size_t i = 0; i < chunk->size(); ++i) {
    if (is_visible(*chunk->views()[i])) rows.push_back(i);
  }
  if (rows.empty()) return nullptr;
  if (rows.size() == chunk->size()) return chunk;
  std::vector<IndexedView> visible;
  visible.reserve(rows.size());
  for (const std::size_t row : rows) {
    visible.push_back({chunk->views()[row], chunk->DescriptorOf(row)});
  }
  return std::make_shared<const DescriptorChunk>(visible, chunk->projection());
}

}  // namespace

DescriptorIndex DescriptorIndex::Filtered(const std::function<bool(const TaughtView&)>& is_visible,
                                          FilteredChunks* known) const {
  DescriptorIndex out = Empty();
  FilteredChunks filtered;
  for (const Chunk& chunk : chunks_) {
    const auto found = known->find(chunk);
    const Chunk& kept =
        filtered
            .emplace(chunk, found != known->end() ? found->second : VisibleOf(chunk, is_visible))
            .first->second;
    if (kept == nullptr) continue;
    out.view_count_ += kept->size();
    out.chunks_.push_back(kept);
  }
  *known = std::move(filtered);
  return out;
}

}  // namespace graspdb::recognition
