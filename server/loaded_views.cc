#include "server/loaded_views.h"

#include <algorithm>
#include <thread>
#include <utility>

namespace graspdb::server {
namespace {

// The index has chunks of 512; a multiple leaves none of them partly filled.
constexpr std::size_t kPortion = 2048;

}  // namespace

ViewCollector::ViewCollector(int size)
    : max_at_work_(std::max(1U, std::thread::hardware_concurrency())), index_(size) {}

void ViewCollector::Add(recognition::IndexedView view) {
  views_.push_back(view.view);
  portion_.push_back(std::move(view));
  if (portion_.size() == kPortion) HandOutPortion();
}

void ViewCollector::HandOutPortion() {
  if (at_work_.size() == max_at_work_) TakeOldest();
  auto work = [empty = index_.Empty(), portion = std::exchange(portion_, {})] {
    return empty.With(portion);
  };
  at_work_.push_back(std::async(std::launch::async, std::move(work)));
}

void ViewCollector::TakeOldest() {
  index_ = index_.Joined(at_work_.front().get());
  at_work_.pop_front();
}

LoadedViews ViewCollector::Finish(std::int64_t revision) {
  HandOutPortion();
  while (!at_work_.empty()) TakeOldest();
  return {revision, std::move(index_), std::move(views_)};
}

}  // namespace graspdb::server
