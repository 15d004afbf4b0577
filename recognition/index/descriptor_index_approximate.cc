// The views of a DescriptorIndex that its approximate index contains.
#include <algorithm>
#include <unordered_map>
#include <utility>

#include "recognition/index/descriptor_index.h"

namespace graspdb::recognition {

void DescriptorIndex::MarkDeleted(const std::unordered_set<const TaughtView*>& removed) {
  if (removed.empty()) return;
  auto deleted = std::make_shared<std::vector<bool>>(*deleted_);
  const auto places = approximate_->places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if ((*deleted)[i]) continue;
    (*deleted)[i] = removed.contains(places[i].chunk->views()[places[i].row].get());
  }
  deleted_ = std::move(deleted);
}

DescriptorIndex DescriptorIndex::WithApproximate(
    std::shared_ptr<const ApproximateIndex> approximate) const {
  DescriptorIndex out = *this;
  out.approximate_ = std::move(approximate);
  out.deleted_ = nullptr;
  out.covered_ = 0;
  if (out.approximate_ == nullptr) return out;
  std::unordered_map<const TaughtView*, std::size_t> numbers;
  const auto places = out.approximate_->places();
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].chunk != nullptr) numbers[places[i].chunk->views()[places[i].row].get()] = i;
  }
  auto deleted = std::make_shared<std::vector<bool>>(places.size(), true);
  std::vector<IndexedView> newer;
  out.chunks_.clear();
  for (const Chunk& chunk : chunks_) {
    std::vector<std::size_t> known;
    for (std::size_t row = 0; row < chunk->size(); ++row) {
      const auto found = numbers.find(chunk->views()[row].get());
      if (found == numbers.end()) {
        newer.push_back({chunk->views()[row], chunk->DescriptorOf(row)});
      } else {
        known.push_back(row);
        (*deleted)[found->second] = false;
      }
    }
    if (known.size() == chunk->size()) {
      out.chunks_.push_back(chunk);
    } else if (!known.empty()) {
      std::vector<IndexedView> kept;
      kept.reserve(known.size());
      for (const std::size_t row : known) {
        kept.push_back({chunk->views()[row], chunk->DescriptorOf(row)});
      }
      out.chunks_.push_back(std::make_shared<const DescriptorChunk>(kept, chunk->projection()));
    }
  }
  out.covered_ = out.chunks_.size();
  out.deleted_ = std::move(deleted);
  out.view_count_ -= newer.size();
  return out.With(newer);
}

std::size_t DescriptorIndex::newer_view_count() const {
  std::size_t out = 0;
  for (std::size_t c = covered_; c < chunks_.size(); ++c) out += chunks_[c]->size();
  return out;
}

std::size_t DescriptorIndex::deleted_view_count() const {
  return deleted_ == nullptr ? 0 : static_cast<std::size_t>(std::ranges::count(*deleted_, true));
}

}  // namespace graspdb::recognition
