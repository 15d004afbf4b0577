// A cache of prepared clouds of views and fused models.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "recognition/descriptors/descriptor.h"
#include "recognition/models/taught.h"
#include "server/base/lru_cache.h"
#include "storage/catalogue/catalogue.h"

namespace graspdb::server {

// Loads clouds from the catalogue, prepares them for the alignment, fuses them, and caches up to
// `byte_budget` bytes, evicting the least recently used first. Thread-safe; two threads that miss
// the same entry at once both compute it.
class ViewCloudCache : public recognition::ViewClouds {
 public:
  // Clouds get 1/kCloudShare of the memory: models are fused from them, and then used instead.
  static constexpr std::size_t kCloudShare = 16;
  // And models for point pairs get 1/kPairModelShare: 2 to 3 MB for each object.
  static constexpr std::size_t kPairModelShare = 4;

  // Called with the name of a view whose cloud is damaged.
  using OnDamage = std::function<void(const std::string& view)>;

  // `catalogue` must outlive this.
  ViewCloudCache(const storage::Catalogue& catalogue,
                 const recognition::DescriptorParameters& parameters, std::size_t byte_budget,
                 OnDamage on_damage = {});

  // NOT_FOUND when a view was deleted after the caller took its snapshot, DATA_LOSS for damage.
  absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> Load(
      const recognition::TaughtView& view) override;
  absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> LoadModel(
      const recognition::TaughtView& view,
      const recognition::TaughtStablePose& stable_pose) override;
  absl::StatusOr<std::shared_ptr<const recognition::PairModel>> LoadPairModel(
      const recognition::StablePoses& stable_poses) override;
  // Makes the next LoadModel() of the same a hit. The bytes of the model if it was not known; it is
  // counted as no request, clouds that it is fused from are. Errors as LoadModel().
  absl::StatusOr<std::size_t> Preload(const recognition::TaughtView& view,
                                      const recognition::TaughtStablePose& stable_pose);

  // The same for LoadPairModel().
  absl::StatusOr<std::size_t> PreloadPairModel(const recognition::StablePoses& stable_poses);

  CacheUse pair_model_use() const { return pair_models_.use(); }
  CacheUse cloud_use() const { return clouds_.use(); }
  CacheUse model_use() const { return models_.use(); }

 private:
  using Cloud = std::shared_ptr<const recognition::OrientedCloud>;

  absl::StatusOr<Cloud> Read(const recognition::TaughtView& view) const;
  absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> Fuse(
      const std::string& key, const recognition::TaughtView& view,
      const recognition::TaughtStablePose& stable_pose);
  absl::StatusOr<std::shared_ptr<const recognition::PairModel>> MakePairs(
      const std::string& key, const recognition::StablePoses& stable_poses);

  const storage::Catalogue& catalogue_;
  const recognition::DescriptorParameters parameters_;
  const OnDamage on_damage_;
  LruCache<recognition::OrientedCloud> clouds_;
  LruCache<recognition::SurfaceModel> models_;
  LruCache<recognition::PairModel> pair_models_;
};

}  // namespace graspdb::server
