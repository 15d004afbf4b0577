#include "recognition/index/descriptor_index.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <utility>

namespace graspdb::recognition {
namespace {

constexpr std::size_t kChunkViews = 512;
// Views measured first for each requested one, to limit the distance of the nearest: the lowest
// bounds mostly belong to the nearest.
constexpr std::size_t kTriedFirst = 3;

// From this many views on, a projection to fewer numbers than bins is worth its fit (50 ms). Fewer
// views are searched in 0.1 ms without.
constexpr std::size_t kFirstFit = 4096;
// Views added after the fit are bounded less well, so that the projection is refitted when their
// number has grown by this factor; packed views stay as they are.
constexpr std::size_t kFitAgain = 4;
constexpr std::size_t kFitSample = 2048;

constexpr float kAnything = std::numeric_limits<float>::infinity();

bool Before(const Match& a, const Match& b) {
  return a.distance != b.distance ? a.distance < b.distance : a.view->name < b.view->name;
}

// The best `count` matches so far that are no farther than `limit`, names breaking ties.
class BestMatches {
 public:
  explicit BestMatches(std::size_t count) : count_(count) {}

  void Lower(float limit) { limit_ = std::min(limit_, limit); }

  // Views farther away are no matches.
  float worst() const {
    const float known =
        matches_.size() < count_ ? kAnything : static_cast<float>(matches_.front().distance);
    return std::min(limit_, known);
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
  float limit_ = kAnything;
  std::vector<Match> matches_;  // a heap, the worst in front
};

// A view's location and the lower bound of its distance.
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

// The query's numbers for each projection of the chunks.
class CodedQuery {
 public:
  explicit CodedQuery(const Descriptor& descriptor) : descriptor_(descriptor) {}

  const CodedNumbers& For(const RootProjection* projection) {
    for (const auto& [known, numbers] : coded_) {
      if (known == projection) return numbers;
    }
    return coded_.emplace_back(projection, NumbersToCode(descriptor_, projection)).second;
  }

 private:
  const Descriptor& descriptor_;
  std::deque<std::pair<const RootProjection*, CodedNumbers>> coded_;
};

// Adds the nearest of some chunks to `best`: first those with the lowest bounds, then all whose
// bounds are not above the worst of the best.
void Scan(std::span<const std::shared_ptr<const DescriptorChunk>> chunks,
          const Descriptor& descriptor, const DescriptorQuery& query, std::size_t wanted,
          BestMatches* best) {
  CodedQuery coded(descriptor);
  LowestBounds lowest(kTriedFirst * wanted);
  std::vector<std::vector<float>> bounds(chunks.size());
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    bounds[c].resize(chunks[c]->size());
    chunks[c]->Bound(coded.For(chunks[c]->projection().get()), bounds[c]);
    lowest.Add(c, bounds[c]);
  }
  std::vector<float> tried;
  tried.reserve(lowest.all().size());
  for (const Bounded& b : lowest.all()) tried.push_back(chunks[b.chunk]->Distance(query, b.row));
  best->Lower(Smallest(wanted, std::move(tried)));
  for (std::size_t c = 0; c < chunks.size(); ++c) {
    for (std::size_t row = 0; row < bounds[c].size(); ++row) {
      if (bounds[c][row] > best->worst()) continue;
      best->Add(chunks[c]->views()[row], chunks[c]->Distance(query, row));
    }
  }
}

std::vector<IndexedView> ViewsOf(const DescriptorChunk& chunk) {
  std::vector<IndexedView> out;
  out.reserve(chunk.size());
  for (std::size_t i = 0; i < chunk.size(); ++i) {
    out.push_back({chunk.views()[i], chunk.DescriptorOf(i)});
  }
  return out;
}

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

DescriptorIndex::DescriptorIndex(int size)
    : bins_(static_cast<std::size_t>(size)), next_fit_(kFirstFit) {}

DescriptorIndex DescriptorIndex::Empty() const {
  DescriptorIndex out(static_cast<int>(bins_));
  out.projection_ = projection_;
  return out;
}

void DescriptorIndex::FitProjection() {
  if (view_count_ < next_fit_) return;
  next_fit_ = kFitAgain * view_count_;
  const std::size_t step = std::max<std::size_t>(1, view_count_ / kFitSample);
  std::vector<std::vector<float>> sample;
  sample.reserve(view_count_ / step + 1);
  std::size_t skipped = 0;  // views before the chunk
  for (const Chunk& chunk : chunks_) {
    for (std::size_t i = (step - skipped % step) % step; i < chunk->size(); i += step) {
      sample.push_back(NumbersToCode(chunk->DescriptorOf(i), nullptr).values);
    }
    skipped += chunk->size();
  }
  if (auto fitted = RootProjection::Fit(sample)) projection_ = std::move(fitted);
  CodeAgain();
}

void DescriptorIndex::CodeAgain() {
  if (projection_ == nullptr) return;
  for (Chunk& chunk : chunks_) {
    if (chunk->projection() != nullptr) continue;
    chunk = std::make_shared<const DescriptorChunk>(ViewsOf(*chunk), projection_);
  }
}

DescriptorIndex DescriptorIndex::With(std::span<const IndexedView> views) const {
  DescriptorIndex out = *this;
  out.view_count_ += views.size();
  if (!out.chunks_.empty() && out.chunks_.back()->size() < kChunkViews && !views.empty()) {
    const DescriptorChunk& last = *out.chunks_.back();
    std::vector<IndexedView> joined = ViewsOf(last);
    const std::size_t taken = std::min(views.size(), kChunkViews - last.size());
    joined.insert(joined.end(), views.begin(), views.begin() + static_cast<std::ptrdiff_t>(taken));
    out.chunks_.back() = std::make_shared<const DescriptorChunk>(joined, projection_);
    views = views.subspan(taken);
  }
  for (; !views.empty(); views = views.subspan(std::min(views.size(), kChunkViews))) {
    out.chunks_.push_back(std::make_shared<const DescriptorChunk>(
        views.first(std::min(views.size(), kChunkViews)), projection_));
  }
  out.FitProjection();
  return out;
}

DescriptorIndex DescriptorIndex::Joined(const DescriptorIndex& other) const {
  DescriptorIndex out = *this;
  out.view_count_ += other.view_count_;
  out.chunks_.insert(out.chunks_.end(), other.chunks_.begin(), other.chunks_.end());
  if (out.projection_ == nullptr) out.projection_ = other.projection_;
  out.CodeAgain();
  out.FitProjection();
  return out;
}

DescriptorIndex DescriptorIndex::Without(const std::unordered_set<std::string>& names) const {
  DescriptorIndex out = *this;
  out.view_count_ = 0;
  out.chunks_.clear();
  for (const Chunk& chunk : chunks_) {
    std::vector<IndexedView> kept;
    for (std::size_t i = 0; i < chunk->size(); ++i) {
      if (names.contains(chunk->views()[i]->name)) continue;
      kept.push_back({chunk->views()[i], chunk->DescriptorOf(i)});
    }
    if (kept.empty()) continue;
    out.view_count_ += kept.size();
    out.chunks_.push_back(kept.size() == chunk->size()
                              ? chunk
                              : std::make_shared<const DescriptorChunk>(kept, chunk->projection()));
  }
  return out;
}

std::vector<Match> DescriptorIndex::Nearest(const Descriptor& descriptor, int count) const {
  if (count <= 0 || descriptor.size() != bins_) return {};
  const DescriptorQuery query(descriptor);
  const auto wanted = static_cast<std::size_t>(count);
  BestMatches best(wanted);
  Scan(chunks_, descriptor, query, wanted, &best);
  return best.TakeSorted();
}

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
