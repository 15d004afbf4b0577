#include "recognition/models/taught.h"

namespace graspdb::recognition {

bool HaveSameModel(const TaughtView& a, const TaughtView& b) {
  return a.name == b.name || (a.stable_pose == b.stable_pose && a.shares_frame && b.shares_frame);
}

std::vector<const TaughtView*> ViewsOfModel(const TaughtView& view,
                                            const TaughtStablePose& stable_pose) {
  // Not looked for among all others: a stable pose may have thousands of such views.
  if (!view.shares_frame) return {&view};
  std::vector<const TaughtView*> all;
  for (const auto& other : stable_pose.views) {
    if (HaveSameModel(view, *other)) all.push_back(other.get());
  }
  if (all.size() <= kMaxFusedViews) return all;
  std::vector<const TaughtView*> out;
  for (std::size_t i = 0; i < kMaxFusedViews; ++i) {
    out.push_back(all[i * all.size() / kMaxFusedViews]);
  }
  return out;
}

absl::StatusOr<std::shared_ptr<const SurfaceModel>> FuseModel(const TaughtView& view,
                                                              const TaughtStablePose& stable_pose,
                                                              ViewClouds& clouds) {
  std::vector<PosedCloud> posed;
  for (const TaughtView* part : ViewsOfModel(view, stable_pose)) {
    auto cloud = clouds.Load(*part);
    if (!cloud.ok()) return cloud.status();
    posed.push_back({*std::move(cloud), part->world_object});
  }
  return FuseViews(posed);
}

}  // namespace graspdb::recognition
