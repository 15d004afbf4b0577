#include "recognition/index/recall.h"

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include "base/status_macros.h"

namespace graspdb::recognition {
namespace {

constexpr int kNeighbors = 10;
constexpr std::size_t kRecallSample = 100;
constexpr double kMinRecall = 0.995;
// About 10 ms a search; with more the exact search is faster.
constexpr int kMaxRecallChecks = 32'768;

using Views = std::vector<std::shared_ptr<const TaughtView>>;

// The nearest of a view that are not the view itself.
Views Others(const DescriptorIndex& index, const TaughtView* self, const Descriptor& descriptor) {
  Views out;
  for (const Match& match : index.Nearest(descriptor, kNeighbors + 1)) {
    if (match.view.get() != self) out.push_back(match.view);
  }
  if (out.size() > kNeighbors) out.pop_back();
  return out;
}

// Views that are spread evenly over an index, and the exact neighbours of each.
class Sample {
 public:
  explicit Sample(const DescriptorIndex& index) {
    const DescriptorIndex exact = index.WithApproximate(nullptr);
    const std::size_t step = std::max<std::size_t>(1, index.view_count() / kRecallSample);
    std::size_t skipped = 0;  // views before the chunk
    for (const auto& chunk : index.chunks()) {
      for (std::size_t i = (step - skipped % step) % step; i < chunk->size(); i += step) {
        const auto& view = chunk->views()[i];
        Descriptor descriptor = chunk->DescriptorOf(i);
        Views nearest = Others(exact, view.get(), descriptor);
        queries_.push_back({view, std::move(descriptor), std::move(nearest)});
      }
      skipped += chunk->size();
    }
  }

  // The share of these neighbours that `index` finds; 1 where there are none.
  double RecallOf(const DescriptorIndex& index) const {
    std::size_t wanted = 0;
    std::size_t hits = 0;
    for (const Query& query : queries_) {
      const Views found = Others(index, query.view.get(), query.descriptor);
      wanted += query.nearest.size();
      hits += static_cast<std::size_t>(std::ranges::count_if(query.nearest, [&](const auto& view) {
        return std::ranges::find(found, view) != found.end();
      }));
    }
    return wanted == 0 ? 1 : static_cast<double>(hits) / static_cast<double>(wanted);
  }

 private:
  struct Query {
    std::shared_ptr<const TaughtView> view;
    Descriptor descriptor;
    Views nearest;
  };
  std::vector<Query> queries_;
};

}  // namespace

absl::StatusOr<DescriptorIndex> WithNewApproximate(const DescriptorIndex& index) {
  ApproximateIndex::SearchParameters search;
  ASSIGN_OR_RETURN(const auto made, ApproximateIndex::Build(index.chunks(), search));
  const DescriptorIndex out = index.WithApproximate(made);
  const Sample sample(out);
  const auto recall = [&] {
    made->Calibrate(search, 0);
    return sample.RecallOf(out);
  };
  while (search.checks < kMaxRecallChecks && recall() < kMinRecall) search.checks *= 2;
  search.checks = std::min(2 * search.checks, kMaxRecallChecks);
  made->Calibrate(search, recall());
  return out;
}

}  // namespace graspdb::recognition
