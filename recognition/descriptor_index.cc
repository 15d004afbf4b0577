#include "recognition/descriptor_index.h"

#include <algorithm>
#include <limits>
#include <utility>

namespace graspdb::recognition {
namespace {

constexpr std::size_t kChunkViews = 512;
// Views that are measured before all others, so many for each that is wanted: the lowest bounds
// mostly belong to the nearest.
constexpr std::size_t kFirstMeasured = 3;

// Not at most anything.
constexpr float kMeasured = std::numeric_limits<float>::quiet_NaN();

bool Before(const Match& a, const Match& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view->name < b.view->name;
}

// The best `count` matches so far, names breaking ties.
class BestMatches {
 public:
  explicit BestMatches(std::size_t count) : count_(count) {}

  // What is farther away than this is none of them.
  float worst() const { return worst_; }

  void Add(const std::shared_ptr<const TaughtView>& view, float distance) {
    if (distance > worst_) return;
    Match match{view, static_cast<double>(distance)};
    if (matches_.size() == count_) {
      if (!Before(match, matches_.front())) return;
      std::pop_heap(matches_.begin(), matches_.end(), Before);
      matches_.back() = std::move(match);
    } else {
      matches_.push_back(std::move(match));
    }
    std::push_heap(matches_.begin(), matches_.end(), Before);
    if (matches_.size() == count_) worst_ = static_cast<float>(matches_.front().distance);
  }

  std::vector<Match> TakeSorted() {
    std::sort_heap(matches_.begin(), matches_.end(), Before);
    return std::move(matches_);
  }

 private:
  std::size_t count_;
  float worst_ = std::numeric_limits<float>::infinity();
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
      if (bounds[row] >= limit_) continue;
      if (heap_.size() == count_) {
        std::pop_heap(heap_.begin(), heap_.end(), Lower);
        heap_.pop_back();
      }
      heap_.push_back({bounds[row], chunk, row});
      std::push_heap(heap_.begin(), heap_.end(), Lower);
      if (heap_.size() == count_) limit_ = heap_.front().bound;
    }
  }

  const std::vector<Bounded>& all() const { return heap_; }

 private:
  static bool Lower(const Bounded& a, const Bounded& b) { return a.bound < b.bound; }

  std::size_t count_;
  float limit_ = std::numeric_limits<float>::infinity();
  std::vector<Bounded> heap_;
};

std::shared_ptr<const DescriptorChunk> MakeChunk(std::span<const IndexedView> views) {
  std::vector<std::shared_ptr<const TaughtView>> names;
  std::vector<const Descriptor*> descriptors;
  names.reserve(views.size());
  descriptors.reserve(views.size());
  for (const IndexedView& v : views) {
    names.push_back(v.view);
    descriptors.push_back(&v.descriptor);
  }
  return std::make_shared<const DescriptorChunk>(std::move(names), descriptors);
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
    out.chunks_.back() = MakeChunk(joined);
    views = views.subspan(taken);
  }
  for (; !views.empty(); views = views.subspan(std::min(views.size(), kChunkViews))) {
    out.chunks_.push_back(MakeChunk(views.first(std::min(views.size(), kChunkViews))));
  }
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
    out.chunks_.push_back(kept.size() == chunk->size() ? chunk : MakeChunk(kept));
  }
  return out;
}

std::vector<Match> DescriptorIndex::Nearest(const Descriptor& descriptor, int count) const {
  if (count <= 0 || descriptor.size() != bins_) return {};
  const DescriptorQuery query(descriptor);
  const auto wanted = static_cast<std::size_t>(count);
  LowestBounds lowest(kFirstMeasured * wanted);
  std::vector<std::vector<float>> bounds(chunks_.size());
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    bounds[c].resize(chunks_[c]->size());
    chunks_[c]->Bound(query, bounds[c]);
    lowest.Add(c, bounds[c]);
  }
  BestMatches best(wanted);
  const auto measure = [&](std::size_t chunk, std::size_t row) {
    best.Add(chunks_[chunk]->views()[row], chunks_[chunk]->Distance(query, row));
  };
  for (const Bounded& b : lowest.all()) {
    measure(b.chunk, b.row);
    bounds[b.chunk][b.row] = kMeasured;
  }
  for (std::size_t c = 0; c < chunks_.size(); ++c) {
    for (std::size_t row = 0; row < bounds[c].size(); ++row) {
      if (bounds[c][row] <= best.worst()) measure(c, row);
    }
  }
  return best.TakeSorted();
}

}  // namespace graspdb::recognition
