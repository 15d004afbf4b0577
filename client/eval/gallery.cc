#include "client/eval/gallery.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "client/eval/shown_segment.h"

namespace graspdb::client {

using recognition::IndexedView;
using recognition::OrientedCloud;
using recognition::TaughtStablePose;
using recognition::TaughtView;

std::string ObjectName(const Workpiece& part) { return absl::StrCat("objects/", part.object_id); }

std::string StablePoseName(const Workpiece& part) {
  return absl::StrCat(ObjectName(part), "/stablePoses/", part.stable_pose_id);
}

Gallery::Gallery(const std::vector<Workpiece>& parts,
                 const recognition::RecognitionParameters& parameters)
    : parts_(&parts), parameters_(parameters) {}

absl::Status Gallery::Teach(const Trial& trial) {
  const Placement& truth = trial.truth.front();
  const Workpiece& part = (*parts_)[truth.part];
  auto shown = SegmentShown(trial, parameters_);
  if (!shown.ok()) {
    return {shown.status().code(),
            absl::StrCat(StablePoseName(part), ": ", shown.status().message())};
  }
  auto view = std::make_shared<TaughtView>();
  view->stable_pose = StablePoseName(part);
  view->object = ObjectName(part);
  view->name = absl::StrFormat("%s/views/%05d", view->stable_pose, views_.size());
  view->content = view->name;
  view->world_object = truth.world_object;
  view->shares_frame = true;
  view->world_sensor = shown->world_sensor;
  auto descriptor = recognition::Describe(shown->segment.cloud, view->world_sensor.translation(),
                                          parameters_.descriptor.kind);
  if (!descriptor.ok()) return descriptor.status();
  clouds_[view->name] = std::make_shared<const OrientedCloud>(std::move(shown->segment.cloud));
  posed_[view->stable_pose].push_back({clouds_[view->name], view->world_object});
  views_.push_back({std::move(view), *std::move(descriptor)});
  return absl::OkStatus();
}

recognition::CatalogueSnapshot Gallery::Snapshot() const {
  auto poses =
      std::make_shared<std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>();
  for (const Workpiece& part : *parts_) {
    auto pose = std::make_shared<TaughtStablePose>();
    pose->name = StablePoseName(part);
    pose->symmetry_order = part.symmetry_order;
    pose->grasps.push_back({.id = "origin"});
    for (const IndexedView& v : views_) {
      if (v.view->stable_pose == pose->name) pose->views.push_back(v.view);
    }
    (*poses)[pose->name] = std::move(pose);
  }
  recognition::DescriptorIndex index(recognition::DescriptorSize(parameters_.descriptor.kind));
  return {.revision = 1, .index = index.With(views_), .stable_poses = std::move(poses)};
}

absl::StatusOr<std::shared_ptr<const OrientedCloud>> Gallery::Load(const TaughtView& view) {
  const auto found = clouds_.find(view.name);
  if (found == clouds_.end()) return absl::NotFoundError(view.name);
  return found->second;
}

absl::StatusOr<std::shared_ptr<const recognition::SurfaceModel>> Gallery::LoadModel(
    const TaughtView& /*view*/, const TaughtStablePose& stable_pose) {
  const std::lock_guard lock(mutex_);
  auto& model = models_[stable_pose.name];
  if (!model) model = recognition::FuseViews(posed_[stable_pose.name]);
  return model;
}

}  // namespace graspdb::client
