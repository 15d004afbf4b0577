#include "recognition/index/approximate_index.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <flann/flann.hpp>
#include <limits>
#include <memory>
#include <utility>

#include "absl/strings/str_cat.h"
#include "base/status_macros.h"

namespace graspdb::recognition {
namespace {

using Index = flann::KMeansIndex<flann::L2<float>>;

constexpr char kLibrary[] = "FLANN " FLANN_VERSION_ ", k-means";
// Children of a node: FLANN's default. 64 take as long at the same recall.
constexpr int kBranching = 32;
// More than 7 rounds of k-means change the recall by less than another seed does.
constexpr int kRounds = 7;
// Views that the projection is fitted to.
constexpr std::size_t kSample = 2048;
// Limits of the search parameters in a file, far above calibrated values.
constexpr int kMaxChecks = 1'000'000;
constexpr int kMaxCandidates = 10'000;

bool IsWithinLimits(const ApproximateIndex::SearchParameters& search) {
  return search.checks > 0 && search.checks <= kMaxChecks && search.candidates > 0 &&
         search.candidates <= kMaxCandidates;
}

absl::Status Failed(const std::exception& error) {
  return absl::InternalError(
      absl::StrCat("FLANN failed (", error.what(), "); start with --index exact"));
}

struct Close {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using File = std::unique_ptr<std::FILE, Close>;

// The nearest `count` that are not deleted.
class Nearest : public flann::ResultSet<float> {
 public:
  Nearest(std::size_t count, const std::vector<bool>& deleted) : count_(count), deleted_(deleted) {
    heap_.reserve(count + 1);
  }

  bool full() const override { return heap_.size() == count_; }
  float worstDist() const override {
    return full() ? heap_.front().first : std::numeric_limits<float>::max();
  }
  void addPoint(float distance, std::size_t index) override {
    if (!deleted_.empty() && deleted_[index]) return;
    // Ties by number, so that the order of visits does not matter.
    const std::pair<float, std::size_t> at(distance, index);
    if (full() && at >= heap_.front()) return;
    heap_.push_back(at);
    std::ranges::push_heap(heap_);
    if (heap_.size() <= count_) return;
    std::ranges::pop_heap(heap_);
    heap_.pop_back();
  }

  std::vector<std::size_t> Numbers() const {
    std::vector<std::size_t> out;
    out.reserve(heap_.size());
    for (const auto& [distance, index] : heap_) out.push_back(index);
    return out;
  }

 private:
  std::size_t count_;
  const std::vector<bool>& deleted_;
  std::vector<std::pair<float, std::size_t>> heap_;  // the worst in front
};

}  // namespace

// FLANN's tree and the points that it refers to.
class ApproximateIndex::Tree {
 public:
  explicit Tree(std::vector<float> points)
      : points_(std::move(points)),
        index_(flann::Matrix<float>(points_.data(), points_.size() / RootProjection::kComponents,
                                    RootProjection::kComponents),
               flann::KMeansIndexParams(kBranching, kRounds)) {}

  void Build() { index_.buildIndex(); }

  absl::Status Load(std::string bytes) {
    const File file(fmemopen(bytes.data(), bytes.size(), "rb"));
    if (file == nullptr) return absl::InternalError("out of memory while loading the index");
    index_.loadIndex(file.get());
    return absl::OkStatus();
  }

  absl::StatusOr<std::string> Save() const {
    char* bytes = nullptr;
    std::size_t size = 0;
    File file(open_memstream(&bytes, &size));
    if (file == nullptr) return absl::InternalError("out of memory while saving the index");
    // FLANN writes and reads with one function, which is not const.
    const_cast<Index&>(index_).saveIndex(file.get());
    file.reset();
    std::string out(bytes, size);
    std::free(bytes);
    return out;
  }

  void Find(const float* query, int checks, Nearest* nearest) const {
    index_.findNeighbors(*nearest, query, flann::SearchParams(checks));
  }

  std::size_t byte_count() const {
    return points_.size() * sizeof(float) + static_cast<std::size_t>(index_.usedMemory());
  }

 private:
  std::vector<float> points_;
  Index index_;
};

namespace {

std::vector<float> RootsAt(const ApproximateIndex::Place& place) {
  return NumbersToCode(place.chunk->DescriptorOf(place.row), nullptr).values;
}

// The points of the tree; those of deleted views are never read.
std::vector<float> PointsOf(std::span<const ApproximateIndex::Place> places,
                            const RootProjection& projection) {
  std::vector<float> out;
  out.reserve(places.size() * RootProjection::kComponents);
  for (const ApproximateIndex::Place& place : places) {
    if (place.chunk == nullptr) {
      out.resize(out.size() + RootProjection::kComponents, 0.0F);
      continue;
    }
    const auto components = projection.Project(RootsAt(place)).components;
    out.insert(out.end(), components.begin(), components.end());
  }
  return out;
}

}  // namespace

absl::StatusOr<std::shared_ptr<ApproximateIndex>> ApproximateIndex::Build(
    std::span<const Chunk> chunks, const SearchParameters& search) {
  std::shared_ptr<ApproximateIndex> out(new ApproximateIndex);
  out->search_ = search;
  out->chunks_.assign(chunks.begin(), chunks.end());
  for (const Chunk& chunk : chunks) {
    for (std::size_t row = 0; row < chunk->size(); ++row)
      out->places_.push_back({chunk.get(), row});
  }
  std::vector<std::vector<float>> sample;
  const std::size_t step = std::max<std::size_t>(1, out->places_.size() / kSample);
  for (std::size_t i = 0; i < out->places_.size(); i += step) {
    sample.push_back(RootsAt(out->places_[i]));
  }
  out->projection_ = RootProjection::Fit(sample);
  if (out->projection_ == nullptr || out->places_.size() < kMaxNeighbors) {
    return absl::FailedPreconditionError(
        "there are too few views for an approximate index, or no two are alike; they are searched "
        "exactly");
  }
  try {
    auto tree = std::make_shared<Tree>(PointsOf(out->places_, *out->projection_));
    tree->Build();
    out->tree_ = std::move(tree);
  } catch (const std::exception& error) {
    return Failed(error);
  }
  return out;
}

absl::StatusOr<std::shared_ptr<const ApproximateIndex>> ApproximateIndex::Load(
    const Saved& saved, std::vector<Place> places, std::vector<Chunk> chunks) {
  if (saved.library != kLibrary) {
    return absl::FailedPreconditionError(absl::StrCat("it was made with ", saved.library));
  }
  if (saved.view_count != places.size()) {
    return absl::FailedPreconditionError("it was made with another number of views");
  }
  if (!IsWithinLimits(saved.search)) {
    return absl::FailedPreconditionError("its search parameters are outside of their limits");
  }
  std::shared_ptr<ApproximateIndex> out(new ApproximateIndex);
  out->search_ = saved.search;
  out->recall_at_10_ = saved.recall_at_10;
  out->chunks_ = std::move(chunks);
  out->places_ = std::move(places);
  out->projection_ = RootProjection::FromNumbers(saved.projection);
  if (out->projection_ == nullptr) return absl::DataLossError("its projection is damaged");
  for (const Chunk& chunk : out->chunks_) {
    if (chunk->bins() != out->projection_->bins()) {
      return absl::FailedPreconditionError("it was made with another descriptor");
    }
  }
  try {
    auto tree = std::make_shared<Tree>(PointsOf(out->places_, *out->projection_));
    RETURN_IF_ERROR(tree->Load(saved.tree));
    out->tree_ = std::move(tree);
  } catch (const std::exception& error) {
    return Failed(error);
  }
  return out;
}

absl::StatusOr<ApproximateIndex::Saved> ApproximateIndex::Save() const {
  try {
    ASSIGN_OR_RETURN(std::string tree, tree_->Save());
    return Saved{kLibrary, projection_->numbers(), std::move(tree), places_.size(),
                 search_,  recall_at_10_};
  } catch (const std::exception& error) {
    return Failed(error);
  }
}

absl::StatusOr<std::vector<std::size_t>> ApproximateIndex::FindCandidates(
    const Descriptor& query, const std::vector<bool>& deleted) const {
  const auto projected = projection_->Project(NumbersToCode(query, nullptr).values);
  try {
    Nearest nearest(static_cast<std::size_t>(search_.candidates), deleted);
    tree_->Find(projected.components.data(), search_.checks, &nearest);
    return nearest.Numbers();
  } catch (const std::exception& error) {
    return Failed(error);
  }
}

std::size_t ApproximateIndex::byte_count() const {
  return tree_->byte_count() + places_.size() * sizeof(Place);
}

}  // namespace graspdb::recognition
