#include "recognition/descriptor_index.h"

#include <algorithm>
#include <flann/flann.hpp>
#include <limits>

namespace graspdb::recognition {
namespace {

constexpr std::size_t kChunkViews = 512;

bool Before(const Match& a, const Match& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view->name < b.view->name;
}

// The best `count` matches so far, over several chunks; FLANN's interface of a
// result set, with names breaking ties.
class BestMatches : public flann::ResultSet<float> {
 public:
  explicit BestMatches(std::size_t count) : count_(count) {}

  void StartChunk(const std::vector<IndexedView>* views) { views_ = views; }
  bool full() const override { return matches_.size() == count_; }
  float worstDist() const override {
    return full() ? static_cast<float>(matches_.front().distance)
                  : std::numeric_limits<float>::max();
  }
  void addPoint(float distance, std::size_t index) override {
    Match match{(*views_)[index].view, static_cast<double>(distance)};
    if (full()) {
      if (!Before(match, matches_.front())) return;
      std::pop_heap(matches_.begin(), matches_.end(), Before);
      matches_.back() = std::move(match);
    } else {
      matches_.push_back(std::move(match));
    }
    std::push_heap(matches_.begin(), matches_.end(), Before);
  }

  std::vector<Match> TakeSorted() {
    std::sort_heap(matches_.begin(), matches_.end(), Before);
    return std::move(matches_);
  }

 private:
  std::size_t count_;
  const std::vector<IndexedView>* views_ = nullptr;
  std::vector<Match> matches_;  // a heap, the worst in front
};

}  // namespace

// Some views and FLANN's index over their descriptors.
class DescriptorIndex::Chunk {
 public:
  Chunk(std::vector<IndexedView> views, std::size_t bins) : views_(std::move(views)) {
    rows_.reserve(views_.size() * bins);
    for (const IndexedView& v : views_) {
      rows_.insert(rows_.end(), v.descriptor.begin(), v.descriptor.end());
    }
    index_ = std::make_unique<Linear>(flann::Matrix<float>(rows_.data(), views_.size(), bins));
    index_->buildIndex();
  }

  void Search(const Descriptor& query, BestMatches* best) const {
    best->StartChunk(&views_);
    index_->findNeighbors(*best, query.data(), flann::SearchParams());
  }

  const std::vector<IndexedView>& views() const { return views_; }

 private:
  using Linear = flann::LinearIndex<flann::ChiSquareDistance<float>>;

  std::vector<IndexedView> views_;
  std::vector<float> rows_;
  std::unique_ptr<Linear> index_;
};

DescriptorIndex::DescriptorIndex(int size) : bins_(static_cast<std::size_t>(size)) {}

DescriptorIndex DescriptorIndex::With(std::span<const IndexedView> views) const {
  DescriptorIndex out = *this;
  std::vector<IndexedView> pending;
  if (!out.chunks_.empty() && out.chunks_.back()->views().size() < kChunkViews) {
    pending = out.chunks_.back()->views();
    out.chunks_.pop_back();
  }
  for (const IndexedView& v : views) {
    pending.push_back(v);
    if (pending.size() < kChunkViews) continue;
    out.chunks_.push_back(std::make_shared<const Chunk>(std::move(pending), bins_));
    pending.clear();
  }
  if (!pending.empty()) {
    out.chunks_.push_back(std::make_shared<const Chunk>(std::move(pending), bins_));
  }
  out.view_count_ += views.size();
  return out;
}

DescriptorIndex DescriptorIndex::Without(const std::unordered_set<std::string>& names) const {
  DescriptorIndex out(static_cast<int>(bins_));
  for (const auto& chunk : chunks_) {
    std::vector<IndexedView> kept;
    for (const IndexedView& v : chunk->views()) {
      if (!names.contains(v.view->name)) kept.push_back(v);
    }
    if (kept.empty()) continue;
    out.view_count_ += kept.size();
    out.chunks_.push_back(kept.size() == chunk->views().size()
                              ? chunk
                              : std::make_shared<const Chunk>(std::move(kept), bins_));
  }
  return out;
}

std::vector<Match> DescriptorIndex::Nearest(const Descriptor& query, int count) const {
  if (count <= 0 || query.size() != bins_) return {};
  BestMatches best(static_cast<std::size_t>(count));
  for (const auto& chunk : chunks_) chunk->Search(query, &best);
  return best.TakeSorted();
}

}  // namespace graspdb::recognition
