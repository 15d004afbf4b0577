#include "server/live/view_cloud_cache.h"

#include <utility>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "base/status_macros.h"
#include "server/live/records.h"
#include "server/requests/record_checks.h"

namespace graspdb::server {
namespace {

// The content is part of a key: a name may be reused with another cloud.
std::string KeyOf(const recognition::TaughtView& view) {
  return absl::StrCat(view.name, "@", view.content);
}

std::string KeyOfModel(const recognition::TaughtView& view,
                       const recognition::TaughtStablePose& stable_pose) {
  std::string content;
  for (const recognition::TaughtView* part : recognition::ViewsOfModel(view, stable_pose)) {
    absl::StrAppend(&content, KeyOf(*part), "\n");
  }
  return Sha256(content);
}

std::string KeyOfPairModel(const recognition::StablePoses& stable_poses) {
  std::string content;
  for (const auto& stable_pose : stable_poses) {
    const recognition::TaughtView* view = recognition::ModelView(*stable_pose);
    if (view != nullptr) absl::StrAppend(&content, KeyOfModel(*view, *stable_pose), "\n");
  }
  return Sha256(content);
}

std::size_t BytesOf(const recognition::OrientedCloud& cloud) {
  return 2 * sizeof(Eigen::Vector3f) * cloud.points.size();
}

}  // namespace

ViewCloudCache::ViewCloudCache(const storage::Catalogue& catalogue,
                               const recognition::DescriptorParameters& parameters,
                               std::size_t byte_budget, OnDamage on_damage)
    : catalogue_(catalogue),
      parameters_(parameters),
      on_damage_(std::move(on_damage)),
      clouds_(byte_budget / kCloudShare),
      models_(byte_budget - byte_budget / kCloudShare - byte_budget / kPairModelShare),
      pair_models_(byte_budget / kPairModelShare) {}

absl::StatusOr<std::shared_ptr<const recognition::OrientedCloud>> ViewCloudCache::Load(
    const recognition::TaughtView& view) {
  const std::string key = KeyOf(view);
  if (Cloud known = clouds_.Get(key)) return known;
  absl::StatusOr<Cloud> cloud = Read(view);
  if (absl::IsDataLoss(cloud.status()) && on_damage_) on_damage_(view.name);
  if (cloud.ok()) clouds_.Put(key, *cloud, BytesOf(**cloud));
  return cloud;
}

absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> ViewCloudCache::LoadModel(
    const recognition::TaughtView& view, const recognition::TaughtStablePose& stable_pose) {
  const std::string key = KeyOfModel(view, stable_pose);
  if (auto known = models_.Get(key)) return known;
  return Fuse(key, view, stable_pose);
}

absl::StatusOr<std::size_t> ViewCloudCache::Preload(
    const recognition::TaughtView& view, const recognition::TaughtStablePose& stable_pose) {
  const std::string key = KeyOfModel(view, stable_pose);
  if (models_.Contains(key)) return 0;
  ASSIGN_OR_RETURN(const auto model, Fuse(key, view, stable_pose));
  return model ? model->bytes() : 0;
}

absl::StatusOr<std::shared_ptr<const recognition::PairModel>> ViewCloudCache::LoadPairModel(
    const recognition::StablePoses& stable_poses) {
  const std::string key = KeyOfPairModel(stable_poses);
  if (auto known = pair_models_.Get(key)) return known;
  return MakePairs(key, stable_poses);
}

absl::StatusOr<std::size_t> ViewCloudCache::PreloadPairModel(
    const recognition::StablePoses& stable_poses) {
  const std::string key = KeyOfPairModel(stable_poses);
  if (pair_models_.Contains(key)) return 0;
  ASSIGN_OR_RETURN(const auto model, MakePairs(key, stable_poses));
  return model ? model->bytes() : 0;
}

absl::StatusOr<std::shared_ptr<const recognition::PairModel>> ViewCloudCache::MakePairs(
    const std::string& key, const recognition::StablePoses& stable_poses) {
  auto model = recognition::MakePairModelOf(stable_poses, *this);
  if (model.ok() && *model) pair_models_.Put(key, *model, (*model)->bytes());
  return model;
}

absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> ViewCloudCache::Fuse(
    const std::string& key, const recognition::TaughtView& view,
    const recognition::TaughtStablePose& stable_pose) {
  auto model = recognition::FuseModel(view, stable_pose, *this);
  if (model.ok() && *model) models_.Put(key, *model, (*model)->bytes());
  return model;
}

absl::StatusOr<ViewCloudCache::Cloud> ViewCloudCache::Read(
    const recognition::TaughtView& view) const {
  ASSIGN_OR_RETURN(std::string packed, catalogue_.GetPackedCloud(view.name));
  ASSIGN_OR_RETURN(storage::ViewRecord record, catalogue_.GetView(view.name));
  if (record.content_digest() != view.content) {
    return absl::NotFoundError(absl::StrCat(view.name, " was replaced"));
  }
  ASSIGN_OR_RETURN(recognition::OrientedCloud cloud,
                   CloudFromPacked(packed, view.world_sensor, parameters_));
  // Their capacity is still that of all points before the voxel grid, several times theirs.
  cloud.points.shrink_to_fit();
  cloud.normals.shrink_to_fit();
  return std::make_shared<const recognition::OrientedCloud>(std::move(cloud));
}

}  // namespace graspdb::server
