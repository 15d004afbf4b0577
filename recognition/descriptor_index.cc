#include "recognition/descriptor_index.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace graspdb::recognition {
namespace {

constexpr std::size_t kChunkViews = 512;
// So many views for each that is wanted say how far the nearest are at most: the lowest bounds
// mostly belong to the nearest.
constexpr std::size_t kTriedFirst = 3;

constexpr float kAnything = std::numeric_limits<float>::infinity();

bool Before(const Match& a, const Match& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view->name < b.view->name;
}

// The best `count` matches so far that are no farther than `limit`, names breaking ties.
class BestMatches {
 public:
  BestMatches(std::size_t count, float limit) : count_(count), limit_(limit) {}

  // What is farther away than this is none of them.
  float worst() const {
    return matches_.size() < count_ ? limit_ : static_cast<float>(matches_.front().distance);
  }

  void Add(const std::shared_ptr<const TaughtView>& view, float distance) {
    if (distance > worst()) return;
    matches_.push_back({view, static_cast<double>(distance)});
    std::ranges::push_heap(matches_, Before);
    if (matches_.size() <= count_) return;
    std::ranges::pop_heap(matches_, Before);
    matches_.pop_back();
  }

  std::vector<Match> TakeSorted() {
    std::ranges::sort_heap(matches_, Before);
    return std::move(matches_);
  }

 private:
  std::size_t count_;
  float limit_;
  std::vector<Match> matches_;  // a heap, the worst in front
};

// A view's place, and what its distance is not smaller than.
struct Bounded {
  float bound;
  std::size_t chunk;
  std::size_t row;
};

// The `count` with the lowest bounds.
class LowestBounds {
 public:
  explicit LowestBounds(std::size_t count) : count_(count) {}

  void Add(std::size_t chunk, std::span<const float> bounds) {
    for (std::size_t row = 0; row < bounds.size(); ++row) {
      if (heap_.size() == count_) {
        if (bounds[row] >= heap_.front().bound) continue;
        std::ranges::pop_heap(heap_, {}, &Bounded::bound);
        heap_.pop_back();
      }
      heap_.push_back({bounds[row], chunk, row});
      std::ranges::push_heap(heap_, {}, &Bounded::bound);
    }
  }

  const std::vector<Bounded>& all() const { return heap_; }

 private:
  std::size_t count_;
  std::vector<Bounded> heap_;
};

// The `count`th smallest; anything where there are fewer.
float Smallest(std::size_t count, std::vector<float> values) {
  if (values.size() < count) return kAnything;
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(count - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace

DescriptorIndex::DescriptorIndex(int size) : bins_(static_cast<std::size_t>(size)) {}

DescriptorIndex DescriptorIndex::With(std::span<const IndexedView> views) const {
  DescriptorIndex out = *this;
  out.view_count_ += views.size();
  if (!out.chunks_.empty() && out.chunks_.back()->size() < kChunkViews && !views.empty()) {
    const DescriptorChunk& last = *out.chunks_.back();
    std::vector<IndexedView> joined;
    const std::size_t taken = std::min(views.size(), kChunkViews - last.size());
    joined.reserve(last.size() + taken);
    for (std::size_t i = 0; i < last.size(); ++i) {
      joined.push_back({last.views()[i], last.DescriptorOf(i)});
    }
    joined.insert(joined.end(), views.begin(), views.begin() + static_cast<std::ptrdiff_t>(taken));
    out.chunks_.back() = std::make_shared<const DescriptorChunk>(joined);
    views = views.subspan(taken);
  }
  for (; !views.empty(); views = views.subspan(std::min(views.size(), kChunkViews))) {
    out.chunks_.push_back(
        std::make_shared<const DescriptorChunk>(views.first(std::min(views.size(), kChunkViews))));
  }
  return out;
}

DescriptorIndex DescriptorIndex::Joined(const DescriptorIndex& other) const {
  DescriptorIndex out = *this;
  out.view_count_ += other.view_count_;
  out.chunks_.insert(out.chunks_.end(), other.chunks_.begin(), other.chunks_.end());
  return out;
}

DescriptorIndex DescriptorIndex::Without(const std::unordered_set<std::string>& names) const {
  DescriptorIndex out(static_cast<int>(bins_));
  for (const auto& chunk : chunks_) {
    std::vector<IndexedView> kept;
    for (std::size_t i = 0; i < chunk->size(); ++i) {
      if (names.contains(chunk->views()[i]->name)) continue;
      kept.push_back({chunk->views()[i], chunk->DescriptorOf(i)});
    }
    if (kept.empty()) continue;
    out.view_count_ += kept.size();
    out.chunks_.push_back(
        kept.size() == chunk->size() ? chunk : std::make_shared<const DescriptorChunk>(kept));
  }
  return out;
}

std::vector<Match> DescriptorIndex::Nearest(const Descriptor& descriptor, int count) const {
  if (count <= 0 || descriptor.size() != bins_) return {};
  const DescriptorQuery query(descriptor);
  const auto wanted = static_cast<std::size_t>(count);
  LowestBounds lowest(kTriedFirst * wanted);
  std::vector<std::vector<float>> bounds(chunks_.size());
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    bounds[c].resize(chunks_[c]->size());
    chunks_[c]->Bound(query, bounds[c]);
    lowest.Add(c, bounds[c]);
  }
  std::vector<float> tried;
  tried.reserve(lowest.all().size());
  for (const Bounded& b : lowest.all()) tried.push_back(chunks_[b.chunk]->Distance(query, b.row));
  BestMatches best(wanted, Smallest(wanted, std::move(tried)));
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    for (std::size_t row = 0; row < bounds[c].size(); ++row) {
      if (bounds[c][row] > best.worst()) continue;
      best.Add(chunks_[c]->views()[row], chunks_[c]->Distance(query, row));
    }
  }
  return best.TakeSorted();
}

}  // namespace graspdb::recognition
