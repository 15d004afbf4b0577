#include "server/loaded_views.h"

#include <utility>

namespace graspdb::server {
namespace {

// The index is cut into chunks of 512; a multiple leaves none of them half full.
constexpr std::size_t kPortion = 4096;

}  // namespace

void ViewCollector::Add(recognition::IndexedView view) {
  views_.push_back(view.view);
  portion_.push_back(std::move(view));
  if (portion_.size() == kPortion) EmptyPortion();
}

void ViewCollector::EmptyPortion() {
  index_ = index_.With(portion_);
  portion_.clear();
}

LoadedViews ViewCollector::Finish(std::int64_t revision) {
  EmptyPortion();
  return {revision, std::move(index_), std::move(views_)};
}

}  // namespace graspdb::server
