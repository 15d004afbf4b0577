#include "recognition/models/taught.h"

#include <algorithm>
#include <map>

#include "base/status_macros.h"

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
    ASSIGN_OR_RETURN(auto cloud, clouds.Load(*part));
    posed.push_back({std::move(cloud), part->world_object});
  }
  return FuseViews(posed);
}

std::vector<StablePoses> PairModelGroups(const TaughtPoses& stable_poses) {
  std::map<std::string, StablePoses> groups;
  for (const auto& [name, stable_pose] : stable_poses) {
    if (stable_pose->views.empty()) continue;
    const bool has_mesh = stable_pose->object_mesh.has_value();
    groups[has_mesh ? stable_pose->views.front()->object : name].push_back(stable_pose);
  }
  std::vector<StablePoses> out;
  for (auto& [key, group] : groups) {
    std::ranges::sort(group, {}, [](const auto& stable_pose) { return stable_pose->name; });
    out.push_back(std::move(group));
  }
  return out;
}

const TaughtView* ModelView(const TaughtStablePose& stable_pose) {
  for (const auto& view : stable_pose.views) {
    if (view->shares_frame) return view.get();
  }
  return stable_pose.views.empty() ? nullptr : stable_pose.views.front().get();
}

absl::StatusOr<std::shared_ptr<const PairModel>> MakePairModelOf(const StablePoses& stable_poses,
                                                                 ViewClouds& clouds) {
  OrientedCloud whole;
  for (const auto& stable_pose : stable_poses) {
    const TaughtView* view = ModelView(*stable_pose);
    if (view == nullptr) continue;
    ASSIGN_OR_RETURN(const auto model, clouds.LoadModel(*view, *stable_pose));
    if (model == nullptr) continue;
    const Eigen::Isometry3f mesh_object =
        stable_pose->object_mesh.value_or(Pose::Identity()).inverse().cast<float>();
    const OrientedCloud& part = model->fine.cloud;
    for (std::size_t i = 0; i < part.points.size(); ++i) {
      whole.points.push_back(mesh_object * part.points[i]);
      whole.normals.push_back(mesh_object.linear() * part.normals[i]);
    }
  }
  return MakePairModel(whole, {});
}

}  // namespace graspdb::recognition
