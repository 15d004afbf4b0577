#include "lab/experiment/gallery.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "base/status_macros.h"
#include "lab/experiment/trials/trial.h"
#include "recognition/base/bounds.h"

namespace graspdb::lab {
namespace {

// A view and its whole object differ by less; more is another unit.
constexpr double kMaxSizeRatio = 20;

double MeshSize(const rendering::Workpiece& part) {
  const recognition::Box box = rendering::BoundsOf(part.mesh);
  return (box.max - box.min).norm();
}

// The limits of pose errors grow with the mesh: with a wrong unit every pose would be right.
absl::Status CheckMeshSize(const rendering::Workpiece& part, double mesh_m, const Trial& trial,
                           const recognition::Points& seen) {
  const auto seen_m = static_cast<double>(recognition::BoundsOf(seen).diagonal().norm());
  const bool fits = mesh_m <= kMaxSizeRatio * seen_m && seen_m <= kMaxSizeRatio * mesh_m;
  if (part.mesh.triangles.empty() || fits) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrFormat(
      "%s: its mesh is %.3g m large, and its view%s %.3g m; both must be in metres",
      StablePoseName(part), mesh_m, trial.file.empty() ? "" : " in " + trial.file, seen_m));
}

}  // namespace

using recognition::IndexedView;
using recognition::OrientedCloud;
using recognition::TaughtStablePose;
using recognition::TaughtView;

std::string ObjectName(const rendering::Workpiece& part) {
  return absl::StrCat("objects/", part.object_id);
}

std::string StablePoseName(const rendering::Workpiece& part) {
  return absl::StrCat(ObjectName(part), "/stablePoses/", part.stable_pose_id);
}

Gallery::Gallery(std::vector<rendering::Workpiece> parts,
                 const recognition::RecognitionParameters& parameters)
    : parts_(std::move(parts)), parameters_(parameters) {
  mesh_sizes_m_.reserve(parts_.size());
  for (const rendering::Workpiece& part : parts_) mesh_sizes_m_.push_back(MeshSize(part));
}

absl::Status Gallery::Teach(const TrialSource& trials, const std::string& step,
                            const ExperimentRun& run) {
  const std::size_t known = views_.size();
  std::vector<std::optional<Described>> described(trials.count);
  absl::Status status = ForEach(trials.count, step, run, [&](std::size_t i) {
    ASSIGN_OR_RETURN(const auto trial, trials.make(i));
    ASSIGN_OR_RETURN(auto made, Describe(trial, known + i));
    described[i] = std::move(made);
    return absl::OkStatus();
  });
  if (!status.ok()) return status;
  for (std::optional<Described>& made : described) {
    Add(made->view.view->name, std::make_shared<const OrientedCloud>(std::move(made->cloud)));
    views_.push_back(std::move(made->view));
  }
  return absl::OkStatus();
}

absl::StatusOr<Gallery::Described> Gallery::Describe(const Trial& trial, std::size_t number) const {
  const rendering::Placement& truth = trial.truth.front();
  const rendering::Workpiece& part = parts_[truth.part];
  auto shown = SegmentShown(trial, parameters_);
  if (!shown.ok()) {
    return absl::Status(shown.status().code(),
                        absl::StrCat(StablePoseName(part), ": ", shown.status().message()));
  }
  RETURN_IF_ERROR(
      CheckMeshSize(part, mesh_sizes_m_[truth.part], trial, shown->segment.cloud.points));
  auto view = std::make_shared<TaughtView>();
  view->stable_pose = StablePoseName(part);
  view->object = ObjectName(part);
  view->name = absl::StrFormat("%s/views/%05d", view->stable_pose, number);
  view->content = view->name;
  view->world_object = truth.world_object;
  if (!trial.posed) {
    view->world_object = recognition::DefaultObjectPose(shown->world_frame, shown->segment);
  }
  view->shares_frame = trial.posed;
  view->world_sensor = shown->world_sensor;
  ASSIGN_OR_RETURN(auto descriptor, recognition::Describe(shown->segment.cloud, view->world_sensor,
                                                          parameters_.descriptor.kind));
  return Described{{std::move(view), std::move(descriptor)}, std::move(shown->segment.cloud)};
}

recognition::CatalogueSnapshot Gallery::Snapshot(std::optional<std::size_t> left_out) const {
  std::vector<IndexedView> views = views_;
  if (left_out) views.erase(views.begin() + static_cast<std::ptrdiff_t>(*left_out));
  auto poses =
      std::make_shared<std::unordered_map<std::string, std::shared_ptr<const TaughtStablePose>>>();
  for (const rendering::Workpiece& part : parts_) {
    auto pose = std::make_shared<TaughtStablePose>();
    pose->name = StablePoseName(part);
    pose->symmetry_order = part.symmetry_order;
    pose->object_mesh = part.object_mesh;
    pose->grasps.push_back({.id = "origin"});
    for (const IndexedView& v : views) {
      if (v.view->stable_pose == pose->name) pose->views.push_back(v.view);
    }
    (*poses)[pose->name] = std::move(pose);
  }
  recognition::DescriptorIndex index(recognition::DescriptorSize(parameters_.descriptor.kind));
  return {.revision = 1, .index = index.With(views), .stable_poses = std::move(poses)};
}

bool Gallery::HasFrame(const rendering::Workpiece& part) const {
  const std::string object = ObjectName(part);
  return std::ranges::any_of(views_, [&object](const IndexedView& v) {
    return v.view->object == object && v.view->shares_frame;
  });
}

std::shared_ptr<const recognition::SurfaceModel> Gallery::ModelOf(
    const rendering::Workpiece& part) {
  const auto snapshot = Snapshot();
  const auto pose = snapshot.stable_poses->find(StablePoseName(part));
  if (pose == snapshot.stable_poses->end() || pose->second->views.empty()) return nullptr;
  const auto& views = pose->second->views;
  const auto posed = std::ranges::find_if(views, [](const auto& v) { return v->shares_frame; });
  auto model = LoadModel(posed == views.end() ? *views.front() : **posed, *pose->second);
  return model.ok() ? *model : nullptr;
}

absl::StatusOr<Gallery*> LastGallery::Teach(const ExperimentCase& experiment, const PartSet& set,
                                            const TrialSource& teaching, const ExperimentRun& run) {
  std::vector<std::string> taught;
  for (std::size_t i = 0; i < set.taught_count; ++i) taught.push_back(StablePoseName(set.parts[i]));
  if (gallery_ != nullptr && taught == taught_ && TeachesAlike(experiment, experiment_)) {
    return gallery_.get();
  }
  gallery_ = std::make_unique<Gallery>(set.parts, run.parameters);
  absl::Status status = gallery_->Teach(teaching, experiment.name + ": teaching", run);
  experiment_ = experiment;
  taught_ = std::move(taught);
  if (status.ok()) return gallery_.get();
  gallery_.reset();
  return status;
}

}  // namespace graspdb::lab
