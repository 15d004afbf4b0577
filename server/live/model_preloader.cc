#include "server/live/model_preloader.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <memory>
#include <string>

#include "program/log/log_field.h"
#include "server/base/background.h"

namespace graspdb::server {
namespace {

// While views are taught one by one, each pass fuses the model of those so far: this is the most
// that it costs. Twice as long, a frame may meet a changed model twice as often.
constexpr std::chrono::milliseconds kInterval{500};

}  // namespace

ModelPreloader::ModelPreloader(const LiveCatalogue& live, ViewCloudCache& clouds)
    : live_(live),
      clouds_(clouds),
      loaded_(std::make_shared<const TaughtPoses>()),
      thread_([this] { Run(); }) {}

ModelPreloader::~ModelPreloader() {
  stop_.Raise();
  thread_.join();
}

void ModelPreloader::Run() {
  LowerPriority();
  do {
    const std::shared_ptr<const LiveSnapshot> now = live_.snapshot();
    if (now->revision == loaded_revision_) continue;
    const absl::Status done = Guarded([&] {
      Pass(*now);
      return absl::OkStatus();
    });
    if (!done.ok()) {
      spdlog::error("event=preload_failed error={}", LogField(std::string(done.message())));
    }
    loaded_ = now->stable_poses;
    loaded_revision_ = now->revision;
  } while (!stop_.Wait(kInterval));
}

void ModelPreloader::Pass(const LiveSnapshot& now) {
  loaded_bytes_ = 0;
  for (const auto& [name, stable_pose] : *now.stable_poses) {
    if (IsOver()) break;
    const auto loaded = loaded_->find(name);
    if (loaded == loaded_->end() || loaded->second != stable_pose) LoadModels(*stable_pose);
  }
  LoadPairModels(*now.stable_poses);
}

// Of the objects with a changed stable pose.
void ModelPreloader::LoadPairModels(const TaughtPoses& stable_poses) {
  const auto is_loaded = [this](const auto& stable_pose) {
    const auto loaded = loaded_->find(stable_pose->name);
    return loaded != loaded_->end() && loaded->second == stable_pose;
  };
  std::size_t bytes = 0;
  for (const recognition::StablePoses& group : recognition::PairModelGroups(stable_poses)) {
    if (stop_.Wait(std::chrono::nanoseconds(0))) return;
    if (static_cast<double>(bytes) >=
        kPreloadedShare * static_cast<double>(clouds_.pair_model_use().byte_budget)) {
      return;
    }
    if (std::ranges::all_of(group, is_loaded)) continue;
    bytes += clouds_.PreloadPairModel(group).value_or(0);
  }
}

void ModelPreloader::LoadModels(const recognition::TaughtStablePose& stable_pose) {
  bool shared_is_loaded = false;  // all views that share a frame have one model
  for (const auto& view : stable_pose.views) {
    if (IsOver()) return;
    if (view->shares_frame && shared_is_loaded) continue;
    shared_is_loaded |= view->shares_frame;
    // A view that was deleted meanwhile, or cannot be read: the frame that needs it reports that.
    loaded_bytes_ += clouds_.Preload(*view, stable_pose).value_or(0);
  }
}

bool ModelPreloader::IsOver() const {
  if (stop_.Wait(std::chrono::nanoseconds(0))) return true;
  return static_cast<double>(loaded_bytes_) >=
         kPreloadedShare * static_cast<double>(clouds_.model_use().byte_budget);
}

}  // namespace graspdb::server
