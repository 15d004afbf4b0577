#include "server/live_catalogue.h"

#include <spdlog/spdlog.h>

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "server/convert.h"
#include "server/log_field.h"
#include "server/records.h"
#include "server/taught_poses.h"
#include "storage/family.h"

namespace graspdb::server {
namespace {

constexpr std::size_t kRedescribeBatch = 256;

absl::StatusOr<recognition::IndexedView> IndexedFromRecord(
    const storage::ViewRecord& record, const recognition::DescriptorParameters& parameters) {
  absl::StatusOr<std::shared_ptr<const recognition::TaughtView>> view = ViewFromRecord(record);
  if (!view.ok()) return view.status();
  const storage::DescriptorRecord* descriptor = FindDescriptor(record, parameters);
  if (descriptor == nullptr) {
    return absl::InternalError(absl::StrCat("view ", record.name(), " has no descriptor"));
  }
  return recognition::IndexedView{*std::move(view),
                                  {descriptor->bins().begin(), descriptor->bins().end()}};
}

// A view that cannot be described with these parameters.
absl::Status CannotDescribe(const std::string& name, const absl::Status& status) {
  return {status.code(),
          absl::StrCat(name, " cannot be described with these parameters: ", status.message(),
                       "; start with the --voxel-size and --normal-radius that it was taught with, "
                       "or delete it with them first")};
}

// Describes the named views again, and stores the result.
absl::Status Redescribe(storage::Catalogue& catalogue, const std::vector<std::string>& names,
                        const recognition::DescriptorParameters& parameters) {
  if (names.empty()) return absl::OkStatus();
  spdlog::info("event=redescribe views={} parameters={}", names.size(),
               LogField(parameters.Fingerprint()));
  std::vector<storage::DescriptorUpdate> updates;
  for (std::size_t i = 0; i < names.size(); ++i) {
    absl::StatusOr<storage::ViewRecord> record = catalogue.GetView(names[i]);
    if (!record.ok()) return record.status();
    absl::StatusOr<std::string> packed = catalogue.GetPackedCloud(names[i]);
    if (!packed.ok()) return packed.status();
    absl::StatusOr<recognition::Pose> sensor = PoseFromProto(record->sensor_pose(), "sensor_pose");
    if (!sensor.ok()) return sensor.status();
    absl::StatusOr<recognition::OrientedCloud> cloud =
        CloudFromPacked(*packed, *sensor, parameters);
    if (!cloud.ok()) return cloud.status();
    absl::StatusOr<storage::DescriptorRecord> descriptor =
        MakeDescriptorRecord(*cloud, *sensor, parameters);
    if (!descriptor.ok()) return CannotDescribe(names[i], descriptor.status());
    updates.push_back({names[i], {*std::move(descriptor)}});
    if (updates.size() < kRedescribeBatch && i + 1 < names.size()) continue;
    if (auto revision = catalogue.ReplaceDescriptors(updates); !revision.ok()) {
      return revision.status();
    }
    updates.clear();
  }
  return absl::OkStatus();
}

// What one change does to views and stable poses.
struct Effects {
  std::vector<recognition::IndexedView> added;
  std::unordered_set<std::string> removed;
  TaughtPoseChange poses;
};

// Reads the after-images in a change. A view that is written again is removed first.
absl::StatusOr<Effects> EffectsOf(const storage::ChangeRecord& change,
                                  const std::unordered_set<std::string>& known,
                                  const recognition::DescriptorParameters& parameters) {
  Effects out;
  for (const storage::Mutation& m : change.mutations()) {
    const bool put = m.kind() == storage::Mutation::KIND_PUT;
    if (m.column_family() == storage::FamilyName(storage::Family::kViews)) {
      if (known.contains(m.key())) out.removed.insert(m.key());
      if (!put) continue;
      storage::ViewRecord record;
      if (!record.ParseFromString(m.value())) return absl::DataLossError("unreadable view");
      absl::StatusOr<recognition::IndexedView> view = IndexedFromRecord(record, parameters);
      if (!view.ok()) return view.status();
      out.added.push_back(*std::move(view));
    } else if (m.column_family() == storage::FamilyName(storage::Family::kStablePoses)) {
      if (!put) {
        out.poses.deleted.push_back(m.key());
        continue;
      }
      v1::StablePose record;
      if (!record.ParseFromString(m.value())) return absl::DataLossError("unreadable stable pose");
      auto pose = StablePoseFromProto(record);
      if (!pose.ok()) return pose.status();
      out.poses.written.push_back(*std::move(pose));
    }
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
  std::vector<std::string> outdated;
  absl::StatusOr<std::int64_t> revision =
      catalogue_.ForEachView([&](const storage::ViewRecord& record) {
        if (FindDescriptor(record, parameters_) == nullptr) outdated.push_back(record.name());
        return absl::OkStatus();
      });
  if (!revision.ok()) return revision.status();
  if (absl::Status status = Redescribe(catalogue_, outdated, parameters_); !status.ok()) {
    return status;
  }
  TaughtPoseChange poses;
  std::vector<recognition::IndexedView> views;
  storage::RecordVisitor visitor;
  visitor.stable_pose = [&](const v1::StablePose& record) {
    auto pose = StablePoseFromProto(record);
    if (!pose.ok()) return pose.status();
    poses.written.push_back(*std::move(pose));
    return absl::OkStatus();
  };
  visitor.view = [&](const storage::ViewRecord& record) {
    absl::StatusOr<recognition::IndexedView> view = IndexedFromRecord(record, parameters_);
    if (!view.ok()) return view.status();
    view_names_.insert(record.name());
    poses.added_views.push_back(view->view);
    views.push_back(*std::move(view));
    return absl::OkStatus();
  };
  revision = catalogue_.ForEach(visitor);
  if (!revision.ok()) return revision.status();
  const recognition::DescriptorIndex empty(recognition::DescriptorSize(parameters_.kind));
  Publish({*revision, empty.With(views), std::make_shared<const TaughtPoses>(Changed({}, poses))});
  return absl::OkStatus();
}

void LiveCatalogue::Apply(const storage::ChangeRecord& change) {
  Snapshot next = *snapshot();
  next.revision = change.revision();
  absl::StatusOr<Effects> effects = EffectsOf(change, view_names_, parameters_);
  if (!effects.ok()) {
    // Handlers check what they write; a record that they let through stays unknown
    // to the recognition, and the log says so.
    spdlog::error("event=change_ignored revision={} error={}", change.revision(),
                  LogField(std::string(effects.status().message())));
    Publish(std::move(next));
    return;
  }
  if (!effects->removed.empty()) {
    next.index = next.index.Without(effects->removed);
    for (const std::string& name : effects->removed) view_names_.erase(name);
  }
  if (!effects->added.empty()) {
    next.index = next.index.With(effects->added);
    for (const auto& added : effects->added) view_names_.insert(added.view->name);
  }
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
