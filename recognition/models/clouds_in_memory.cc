#include "recognition/models/clouds_in_memory.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace graspdb::recognition {
namespace {

std::string KeyOf(const TaughtView& view, const TaughtStablePose& stable_pose) {
  std::string key;
  for (const TaughtView* part : ViewsOfModel(view, stable_pose)) {
    absl::StrAppend(&key, part->name, "\n");
  }
  return key;
}

}  // namespace

void CloudsInMemory::Add(const std::string& name, std::shared_ptr<const OrientedCloud> cloud) {
  clouds_[name] = std::move(cloud);
}

absl::StatusOr<std::shared_ptr<const OrientedCloud>> CloudsInMemory::Load(const TaughtView& view) {
  const auto found = clouds_.find(view.name);
  if (found == clouds_.end()) return absl::NotFoundError(view.name);
  return found->second;
}

absl::StatusOr<std::shared_ptr<const SurfaceModel>> CloudsInMemory::LoadModel(
    const TaughtView& view, const TaughtStablePose& stable_pose) {
  const std::string key = KeyOf(view, stable_pose);
  const std::lock_guard lock(mutex_);
  auto& known = models_[key];
  if (known) return known;
  auto model = FuseModel(view, stable_pose, *this);
  if (model.ok()) known = *model;
  return model;
}

absl::StatusOr<std::shared_ptr<const PairModel>> CloudsInMemory::LoadPairModel(
    const StablePoses& stable_poses) {
  std::string key;
  for (const auto& stable_pose : stable_poses) {
    const TaughtView* view = ModelView(*stable_pose);
    if (view != nullptr) absl::StrAppend(&key, KeyOf(*view, *stable_pose), "\n");
  }
  {
    const std::lock_guard lock(mutex_);
    const auto known = pair_models_.find(key);
    if (known != pair_models_.end()) return known->second;
  }
  auto model = MakePairModelOf(stable_poses, *this);
  if (!model.ok()) return model;
  const std::lock_guard lock(mutex_);
  return pair_models_.try_emplace(key, *std::move(model)).first->second;
}

}  // namespace graspdb::recognition
