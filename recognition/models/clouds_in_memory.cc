#include "recognition/models/clouds_in_memory.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"

namespace graspdb::recognition {

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
  std::string key;
  for (const TaughtView* part : ViewsOfModel(view, stable_pose)) {
    absl::StrAppend(&key, part->name, "\n");
  }
  const std::lock_guard lock(mutex_);
  auto& known = models_[key];
  if (known) return known;
  auto model = FuseModel(view, stable_pose, *this);
  if (model.ok()) known = *model;
  return model;
}

}  // namespace graspdb::recognition
