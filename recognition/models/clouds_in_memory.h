// Clouds of views in memory, and the models that are fused from them.
#pragma once

#include <memory>
#include <mutex>
#include <string>
#include <unordered_map>

#include "absl/status/statusor.h"
#include "recognition/models/taught.h"

namespace graspdb::recognition {

// Keeps all added clouds and fuses each model once. Adding is not thread-safe; loading is.
class CloudsInMemory : public ViewClouds {
 public:
  // Adds the cloud of the view of that resource name, once.
  void Add(const std::string& name, std::shared_ptr<const OrientedCloud> cloud);

  // NOT_FOUND for a view whose cloud was not added.
  absl::StatusOr<std::shared_ptr<const OrientedCloud>> Load(const TaughtView& view) override;
  absl::StatusOr<std::shared_ptr<const SurfaceModel>> LoadModel(
      const TaughtView& view, const TaughtStablePose& stable_pose) override;
  absl::StatusOr<std::shared_ptr<const PairModel>> LoadPairModel(
      const StablePoses& stable_poses) override;

 private:
  std::unordered_map<std::string, std::shared_ptr<const OrientedCloud>> clouds_;
  std::mutex mutex_;  // guards what follows
  // By the names of the views that they are fused from.
  std::unordered_map<std::string, std::shared_ptr<const SurfaceModel>> models_;
  // By the names of the views of all stable poses.
  std::unordered_map<std::string, std::shared_ptr<const PairModel>> pair_models_;
};

}  // namespace graspdb::recognition
