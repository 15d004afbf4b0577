#include "recognition/recall.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace graspdb::recognition {
namespace {

constexpr int kNeighbors = 10;
constexpr std::size_t kSample = 100;
constexpr double kLeastRecall = 0.995;
// 10 ms a search; more is slower than looking at all.
constexpr int kMostChecks = 32'768;

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

}  // namespace

double RecallAt10(const DescriptorIndex& index) {
  const DescriptorIndex exact = index.WithApproximate(nullptr);
  const std::size_t step = std::max<std::size_t>(1, index.view_count() / kSample);
  std::size_t wanted = 0;
  std::size_t hits = 0;
  std::size_t skipped = 0;  // views before the chunk
  for (const auto& chunk : index.chunks()) {
    for (std::size_t i = (step - skipped % step) % step; i < chunk->size(); i += step) {
      const TaughtView* self = chunk->views()[i].get();
      const Descriptor descriptor = chunk->DescriptorOf(i);
      const Views found = Others(index, self, descriptor);
      for (const auto& view : Others(exact, self, descriptor)) {
        ++wanted;
        hits += std::ranges::find(found, view) != found.end() ? 1 : 0;
      }
    }
    skipped += chunk->size();
  }
  return wanted == 0 ? 1 : static_cast<double>(hits) / static_cast<double>(wanted);
}

absl::StatusOr<DescriptorIndex> WithNewApproximate(const DescriptorIndex& index) {
  ApproximateIndex::Effort effort;
  const auto made = ApproximateIndex::Build(index.chunks(), effort);
  if (!made.ok()) return made.status();
  DescriptorIndex out = index.WithApproximate(*made);
  while (effort.checks < kMostChecks && RecallAt10(out) < kLeastRecall) {
    effort.checks *= 2;
    out = out.WithApproximate((*made)->Calibrated(effort, 0));
  }
  effort.checks = std::min(2 * effort.checks, kMostChecks);
  out = out.WithApproximate((*made)->Calibrated(effort, 0));
  return out.WithApproximate((*made)->Calibrated(effort, RecallAt10(out)));
}

}  // namespace graspdb::recognition
