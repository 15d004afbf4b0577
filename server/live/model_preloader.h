// Fuses models before the first frame needs them.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "program/base/stop_flag.h"
#include "server/live/live_catalogue.h"
#include "server/live/view_cloud_cache.h"

namespace graspdb::server {

// A thread of low priority (LowerPriority) that fuses the models of all stable poses after the
// start, and every half second those of the changed ones, at most kPreloadedShare of the cache each
// time. A frame that needs a model before that fuses it itself: 10 ms for 12 views, a second for
// 400.
class ModelPreloader {
 public:
  // Of the cache's budget. The rest is for models that frames need. If it were twice as much,
  // loading a large catalogue would evict the models that the frames of today use. Models of
  // earlier versions of a stable pose are evicted as the least recently used ones.
  static constexpr double kPreloadedShare = 0.5;

  // `live` and `clouds` must outlive this.
  ModelPreloader(const LiveCatalogue& live, ViewCloudCache& clouds);
  // Stops.
  ~ModelPreloader();
  ModelPreloader(const ModelPreloader&) = delete;
  ModelPreloader& operator=(const ModelPreloader&) = delete;

  // Ends after the model that is being fused, which takes at most some seconds. Does not wait.
  void Stop() { stop_.Raise(); }

  // The models up to this revision of the catalogue are in the cache, as far as its share goes; -1
  // before the first pass. Thread-safe.
  std::int64_t loaded_revision() const { return loaded_revision_; }

 private:
  void Run();
  void Pass(const LiveSnapshot& now);
  void LoadModels(const recognition::TaughtStablePose& stable_pose);
  void LoadPairModels(const TaughtPoses& stable_poses);
  // Stopped, or this pass has filled its share of the cache.
  bool IsOver() const;

  const LiveCatalogue& live_;
  ViewCloudCache& clouds_;
  std::size_t loaded_bytes_ = 0;  // in this pass
  mutable StopFlag stop_;
  std::shared_ptr<const TaughtPoses> loaded_;  // of the last pass; its thread only
  std::atomic<std::int64_t> loaded_revision_ = -1;
  std::thread thread_;
};

}  // namespace graspdb::server
