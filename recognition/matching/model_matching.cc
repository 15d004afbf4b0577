#include "recognition/matching/model_matching.h"

#include <algorithm>
#include <iterator>
#include <unordered_set>
#include <utility>

namespace graspdb::recognition {
namespace {

// Factor of the number of views each time, until one explains it. Doubled, the answers of
// docs/experiment.md are the same.
constexpr std::size_t kGrowth = 4;
// Factor of the number of views where a side is not seen, since the descriptor is not distinctive
// then. Of 81 objects with 40 % hidden from a Carmine 91 % were found instead of 88 (ADR 23).
// Doubled, the answers of docs/experiment.md are the same.
constexpr int kCutOffViews = 4;

}  // namespace

ModelSearch::ModelSearch(const MatchingInput& input, const ScanDepths& depths,
                         Descriptor descriptor, std::span<const Match> nearest,
                         const CatalogueSnapshot& catalogue, ViewClouds& clouds,
                         const MatchingParameters& parameters, const IsCancelled& is_cancelled)
    : descriptor_(std::move(descriptor)),
      catalogue_(catalogue),
      parameters_(parameters),
      matcher_(depths, input.segmentation, input.segment, catalogue, clouds, parameters,
               is_cancelled),
      hidden_(matcher_.depth_buffer().HiddenSides()) {
  for (const Match& match : nearest) nearest_.push_back(match.view);
}

absl::StatusOr<bool> ModelSearch::TryNearest() {
  const auto large_enough = matcher_.LargeEnough(nearest_);
  if (!large_enough.ok()) return large_enough.status();
  if (absl::Status status = matcher_.Propose(*large_enough, hidden_); !status.ok()) return status;
  return IsCutOff() ? matcher_.IsExplainedWhole() : matcher_.IsExplained();
}

absl::Status ModelSearch::TryFurther(SearchBudget& budget) {
  const DepthBuffer::Sides unseen = matcher_.depth_buffer().UnseenSides();
  Views further = FurtherViews(unseen);
  Views tried = nearest_;
  if (IsCutOff()) {
    // The descriptor of a part is not distinctive, and other objects explain a part as well.
    if (auto status = matcher_.ProposeBest(further, hidden_, budget); !status.ok()) return status;
    if (matcher_.IsExplained()) return absl::OkStatus();
    std::ranges::move(further, std::back_inserter(tried));
    further.clear();
  }
  // Tried views are tried again, first, only where their objects could stand elsewhere.
  if (unseen != hidden_) further.insert(further.begin(), tried.begin(), tried.end());
  if (further.empty()) return absl::OkStatus();
  std::size_t portion = kGrowth * tried.size();
  for (std::span<const Views::value_type> left(further); !left.empty(); portion *= kGrowth) {
    const auto next = left.first(std::min(portion, left.size()));
    left = left.subspan(next.size());
    if (auto status = matcher_.ProposeBest(next, unseen, budget); !status.ok()) return status;
    if (matcher_.IsExplained()) return absl::OkStatus();
  }
  if (parameters_.min_score > 0 || IsCutOff() || !matcher_.ExplainsNothing()) {
    return absl::OkStatus();
  }
  // An answer is required: the nearest descriptor is more reliable than the best failed hypothesis.
  matcher_.Forget();
  return matcher_.Propose({nearest_.data(), 1}, hidden_);
}

Views ModelSearch::FurtherViews(const DepthBuffer::Sides& unseen) const {
  const bool is_whole = unseen == DepthBuffer::Sides{} && !IsCutOff();
  const int count = parameters_.further_view_count * (is_whole ? 1 : kCutOffViews);
  std::unordered_set<const TaughtView*> known;
  for (const auto& view : nearest_) known.insert(view.get());
  Views out;
  for (const Match& match : catalogue_.index.Nearest(descriptor_, count)) {
    if (!known.contains(match.view.get())) out.push_back(match.view);
  }
  return out;
}

}  // namespace graspdb::recognition
