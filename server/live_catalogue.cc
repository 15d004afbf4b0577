#include "server/live_catalogue.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <string>
#include <unordered_set>
#include <utility>
#include <vector>

#include "logging/log_field.h"
#include "server/convert.h"
#include "server/load_views.h"
#include "server/records.h"
#include "server/taught_poses.h"
#include "storage/family.h"

namespace graspdb::server {
namespace {

bool Knows(const TaughtPoses& poses, const std::string& view_name) {
  const auto pose = poses.find(PoseOfView(view_name));
  if (pose == poses.end()) return false;
  const auto name = [](const auto& view) -> const std::string& { return view->name; };
  return std::ranges::binary_search(pose->second->views, view_name, {}, name);
}

// What one change does to views and stable poses.
struct Effects {
  std::vector<recognition::IndexedView> added;
  std::unordered_set<std::string> removed;
  TaughtPoseChange poses;
};

TaughtOutcomes OutcomesFromRecord(const storage::GraspOutcomesRecord& record) {
  TaughtOutcomes out = {.stable_pose = record.name(), .picks = {}};
  for (const v1::GraspOutcomeCounts& counts : record.counts()) {
    out.picks[counts.grasp_id()] = {counts.picked_count(), counts.missed_count(),
                                    counts.slipped_count()};
  }
  return out;
}

bool IsPut(const storage::Mutation& mutation) {
  return mutation.kind() == storage::Mutation::KIND_PUT;
}

// A view that is written again is removed first.
absl::Status AddViewEffect(const storage::Mutation& mutation, const TaughtPoses& known,
                           const recognition::DescriptorParameters& parameters, Effects* out) {
  if (Knows(known, mutation.key())) out->removed.insert(mutation.key());
  if (!IsPut(mutation)) return absl::OkStatus();
  storage::ViewRecord record;
  if (!record.ParseFromString(mutation.value())) return absl::DataLossError("unreadable view");
  absl::StatusOr<recognition::IndexedView> view = IndexedViewFromRecord(record, parameters);
  if (!view.ok()) return view.status();
  out->added.push_back(*std::move(view));
  return absl::OkStatus();
}

absl::Status AddStablePoseEffect(const storage::Mutation& mutation, Effects* out) {
  if (!IsPut(mutation)) {
    out->poses.deleted.push_back(mutation.key());
    return absl::OkStatus();
  }
  v1::StablePose record;
  if (!record.ParseFromString(mutation.value())) {
    return absl::DataLossError("unreadable stable pose");
  }
  auto pose = StablePoseFromProto(record);
  if (!pose.ok()) return pose.status();
  out->poses.written.push_back(*std::move(pose));
  return absl::OkStatus();
}

absl::Status AddOutcomesEffect(const storage::Mutation& mutation, Effects* out) {
  storage::GraspOutcomesRecord record;
  record.set_name(mutation.key());
  if (IsPut(mutation) && !record.ParseFromString(mutation.value())) {
    return absl::DataLossError("unreadable outcomes");
  }
  out->poses.outcomes.push_back(OutcomesFromRecord(record));
  return absl::OkStatus();
}

// Reads the after-images in a change.
absl::StatusOr<Effects> EffectsOf(const storage::ChangeRecord& change, const TaughtPoses& known,
                                  const recognition::DescriptorParameters& parameters) {
  Effects out;
  for (const storage::Mutation& mutation : change.mutations()) {
    const std::string& family = mutation.column_family();
    absl::Status status;
    if (family == storage::FamilyName(storage::Family::kViews)) {
      status = AddViewEffect(mutation, known, parameters, &out);
    } else if (family == storage::FamilyName(storage::Family::kStablePoses)) {
      status = AddStablePoseEffect(mutation, &out);
    } else if (family == storage::FamilyName(storage::Family::kGraspOutcomes)) {
      status = AddOutcomesEffect(mutation, &out);
    }
    if (!status.ok()) return status;
  }
  out.poses.removed_views.assign(out.removed.begin(), out.removed.end());
  for (const auto& added : out.added) out.poses.added_views.push_back(added.view);
  return out;
}

}  // namespace

LiveCatalogue::LiveCatalogue(storage::Catalogue& catalogue,
                             const recognition::DescriptorParameters& parameters)
    : catalogue_(catalogue), parameters_(parameters) {}

LiveCatalogue::~LiveCatalogue() {
  // Nothing to be done about a failure: it says that we are inside the listener.
  (void)catalogue_.Subscribe({});
}

absl::StatusOr<std::unique_ptr<LiveCatalogue>> LiveCatalogue::Follow(
    storage::Catalogue& catalogue, const recognition::DescriptorParameters& parameters) {
  std::unique_ptr<LiveCatalogue> out(new LiveCatalogue(catalogue, parameters));
  if (absl::Status status = out->Load(); !status.ok()) return status;
  absl::StatusOr<std::int64_t> from = catalogue.Subscribe(
      [live = out.get()](const storage::ChangeRecord& change) { live->Apply(change); });
  if (!from.ok()) return from.status();
  if (*from != out->snapshot()->revision) {
    return absl::InternalError("the catalogue changed while it was loaded");
  }
  return out;
}

absl::Status LiveCatalogue::Load() {
  absl::StatusOr<LoadedViews> loaded = LoadViews(catalogue_, parameters_);
  if (!loaded.ok()) return loaded.status();
  TaughtPoseChange poses;
  storage::RecordVisitor visitor;
  visitor.stable_pose = [&](const v1::StablePose& record) {
    auto pose = StablePoseFromProto(record);
    if (!pose.ok()) return pose.status();
    poses.written.push_back(*std::move(pose));
    return absl::OkStatus();
  };
  visitor.grasp_outcomes = [&](const storage::GraspOutcomesRecord& record) {
    poses.outcomes.push_back(OutcomesFromRecord(record));
    return absl::OkStatus();
  };
  const absl::StatusOr<std::int64_t> revision = catalogue_.ForEach(visitor);
  if (!revision.ok()) return revision.status();
  file_revision_ = loaded->file_revision;
  poses.added_views = std::move(loaded->views);
  Publish({loaded->revision, std::move(loaded->index),
           std::make_shared<const TaughtPoses>(Changed({}, poses))});
  return absl::OkStatus();
}

void LiveCatalogue::Apply(const storage::ChangeRecord& change) {
  Snapshot next = *snapshot();
  next.revision = change.revision();
  absl::StatusOr<Effects> effects = EffectsOf(change, *next.stable_poses, parameters_);
  if (!effects.ok()) {
    // Handlers check what they write; a record that they let through stays unknown
    // to the recognition, and the log says so.
    spdlog::error("event=change_ignored revision={} error={}", change.revision(),
                  LogField(std::string(effects.status().message())));
    Publish(std::move(next));
    return;
  }
  if (!effects->removed.empty()) next.index = next.index.Without(effects->removed);
  if (!effects->added.empty()) next.index = next.index.With(effects->added);
  next.stable_poses =
      std::make_shared<const TaughtPoses>(Changed(*next.stable_poses, effects->poses));
  Publish(std::move(next));
}

void LiveCatalogue::Publish(Snapshot snapshot) {
  auto next = std::make_shared<const Snapshot>(std::move(snapshot));
  absl::MutexLock lock(&mutex_);
  snapshot_.swap(next);  // the old one is let go of after the lock
}

std::shared_ptr<const recognition::CatalogueSnapshot> LiveCatalogue::snapshot() const {
  absl::MutexLock lock(&mutex_);
  return snapshot_;
}

}  // namespace graspdb::server
